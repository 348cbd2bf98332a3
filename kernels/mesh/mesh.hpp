/// Numbering of one body's active nodes and cells.
#pragma once

#include <vector>

#include "core/cells/cut_cells.hpp"
#include "core/scene/scene.hpp"
#include "kernels/mesh/hex.hpp"
#include "kernels/mesh/interpolate.hpp"
#include "kernels/mesh/views.hpp"

namespace cgcontact {

/// Scales of the dimensionless system: lengths by `length`, stresses by `stress`.
struct Scales {
  double length = 1;  ///< m
  double stress = 1;  ///< Pa
};

/// Active nodes of one body (corners of active cells) and the nodes of its cells.
/// Displacements are stored node by node (x, y, z in grid axes), in units of Scales::length;
/// node numbers run through all bodies (first_node .. first_node + num_nodes).
struct BodyMesh {
  const CutCells* cut_cells = nullptr;
  UnitElasticity law;
  double modulus = 1;  ///< E / Scales::stress
  double length = 1;   ///< Scales::length, m
  int first_node = 0, num_nodes = 0;
  std::vector<Index3> nodes;                   ///< place in the grid of each active node, by k, j, i
  GridNumbers node_numbers;                    ///< of this body's nodes: indices into nodes
  std::vector<std::array<int, 8>> cell_nodes;  ///< node numbers (all bodies) of each active cell

  /// Size of an active cell, and of the cells of a level, in units of Scales::length.
  double h(int cell) const { return cut_cells->h(cell) / length; }
  double h_of_level(int level) const { return cut_cells->grid.cell_size_of(level) / length; }
  /// Factor from gradients per cell unit to stresses in units of Scales::stress.
  double stress_factor(int cell) const { return modulus / h(cell); }
  /// Number among the nodes of all bodies of the one at a place of the grid, or -1.
  int find_node(const Index3& place) const {
    const int node = node_numbers.find(place);
    return node < 0 ? -1 : first_node + node;
  }
  double poisson_ratio() const { return law.lambda / (2 * (law.lambda + law.mu)); }
};

/// Whether the face between two active cells carries the ghost penalty: where a cell is filled by less than a quarter,
/// which cannot hold its nodes by itself. On the faces of all cut cells the penalty costs
/// twice the time and gives nothing: docs/decisions.md, "Ghost penalty".
bool is_ghost_face(const BodyMesh& mesh, int e, int f);

BodyMesh make_body_mesh(const CutCells& cut_cells, const Material& material, const Scales& scales, int first_node);

}  // namespace cgcontact
