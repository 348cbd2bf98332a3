/// Rigid motions of a body's nodes: what nodal values sum to, and a motion added to them. Grid axes, cells.
#pragma once

#include "kernels/mesh/mesh.hpp"

namespace cgcontact {

/// Returns the mean position of the nodes, grid coordinates.
Vec3 centre_of_nodes(const BodyMesh& mesh);

/// Sum of a vector over the nodes, and of its moments about a centre.
struct NodeSums {
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
};

/// Sums u of all bodies. In a fixed order: the same on any number of threads.
NodeSums sums_of_nodes(const ExecSpace& exec, const BodyMesh& mesh, const Vec3& centre,
                       const Kokkos::View<const double*, MemSpace>& u);

/// Adds translation + rotation x (x - centre) to u.
void add_rigid_motion(const ExecSpace& exec, const BodyMesh& mesh, const Vec3& centre, const Vec3& translation,
                      const Vec3& rotation, const RealView& u);

}  // namespace cgcontact
