/// Required div sigma where body forces act (paper, equation 4).
#pragma once

#include <functional>

#include "recovery/patch/boundary_data.hpp"
#include "recovery/patch/patches.hpp"

namespace cgcontact {

/// Returns div sigma at a point of a body, per `unit` of length (both in its grid coordinates); in units of
/// Scales::stress, grid axes.
inline Vec3 divergence_at(const BoundaryData& boundary, const Grid& grid, double stress_scale, const Vec3& position,
                          double unit) {
  if (!boundary.body_force_at) return Vec3::Zero();
  return -unit * grid.cell_size / stress_scale *
         (grid.rotation.transpose() * boundary.body_force_at(grid.to_global(position)));
}

/// Returns div sigma at the nodes of a body, per unit of their polynomials; empty without body forces. Refers to the
/// mesh.
inline std::function<Vec3(int node)> divergence_at_nodes(const BodyMesh& mesh, const BoundaryData& boundary,
                                                         double stress_scale) {
  if (!boundary.body_force_at) return {};
  BoundaryData force;
  force.body_force_at = boundary.body_force_at;
  return [&mesh, force, stress_scale](int node) {
    return divergence_at(force, mesh.cut_cells->grid, stress_scale, mesh.node_position(node), unit_of(mesh, node));
  };
}

}  // namespace cgcontact
