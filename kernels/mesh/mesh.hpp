/// Numbering of one body's active nodes and cells.
#pragma once

#include <vector>

#include "core/cells/cut_cells.hpp"
#include "core/scene/scene.hpp"
#include "kernels/mesh/dof_map.hpp"
#include "kernels/mesh/hex.hpp"
#include "kernels/mesh/interpolate.hpp"
#include "kernels/mesh/views.hpp"

namespace cgcontact {

/// Scales of the dimensionless system: lengths by `length`, stresses by `stress`.
struct Scales {
  double length = 1;  ///< m
  double stress = 1;  ///< Pa
};

/// A face between a cell and a cell of twice the size beside it, that carries the ghost penalty. On its level the
/// larger cell is represented by a virtual child, which has nodes but no stiffness.
struct LevelFace {
  int cell;       ///< the smaller cell
  Index3 lower;   ///< index of the lower of the two cells: the smaller one or the virtual child
  int direction;  ///< of the face's normal
};

/// Active nodes of one body (corners of active cells) and the nodes of its cells. Displacements are stored node by node
/// (x, y, z in grid axes), in units of Scales::length; node numbers run through all bodies (first_node .. first_node +
/// num_nodes).
///
/// A body of several levels has a mesh for each (`level_meshes`), on a grid of one level, with its own numbers for all
/// corners of its cells; the body's own lists are those of the levels in turn. Nodes are constrained where levels meet:
/// those that stand for a node of a larger cell, hanging nodes, nodes of virtual children. In plane strain
/// (Grid::plane_strain) those of the upper side are.
struct BodyMesh {
  const CutCells* cut_cells = nullptr;
  UnitElasticity law;
  double modulus = 1;  ///< E / Scales::stress; of a rigid body a large number that preconditioners see
  bool rigid = false;  ///< moves as a whole (RigidBodies)
  double length = 1;   ///< Scales::length, m
  int first_node = 0, num_nodes = 0;
  std::vector<Index3> nodes;                   ///< index of each active node in the grid of its level, by k, j, i
  GridNumbers node_numbers;                    ///< of the nodes of a body of one level: indices into nodes
  std::vector<std::array<int, 8>> cell_nodes;  ///< node numbers (all bodies) of each active cell
  std::vector<BodyMesh> level_meshes;          ///< of each level; empty: one level
  std::vector<signed char> node_levels;        ///< of each node; empty: 0
  std::vector<NodeConstraint> constraints;     ///< node numbers (all bodies), ascending in node; masters are free
  std::vector<int> constraint_of_node;         ///< of each node: index into constraints, -1: free; empty: all are free
  std::vector<LevelFace> level_faces;          ///< of a level: towards larger cells

  /// Return the size of an active cell, and of the cells of a level, in units of Scales::length.
  double h(int cell) const { return cut_cells->h(cell) / length; }
  double h_of_level(int level) const { return cut_cells->grid.cell_size_of(level) / length; }
  /// Thickness for which the cells of a level count, in units of Scales::length: their size, or that of the slice.
  double thickness_of_level(int level) const {
    return cut_cells->grid.is_quadtree() ? cut_cells->grid.slice / length : h_of_level(level);
  }
  /// Returns the factor from gradients per cell unit to stresses in units of Scales::stress.
  double stress_factor(int cell) const { return modulus / h(cell); }
  /// Returns the position of a node (index into nodes), grid coordinates.
  Vec3 node_position(int node) const {
    const Vec3 position(nodes[node][0], nodes[node][1], nodes[node][2]);
    return node_levels.empty() ? position : Vec3(std::ldexp(1.0, -node_levels[node]) * position);
  }
  /// Whether the body is one layer of cells thick: in plane strain, or of revolution.
  bool is_one_layer() const { return cut_cells->grid.plane_strain >= 0; }
  bool is_axisymmetric() const { return cut_cells->grid.is_axisymmetric(); }
  /// Returns twice the distance of a cell's middle from the axis of revolution, in cells.
  double diameter_of(int cell) const {
    return 2 * cut_cells->grid.radius(grid_position(*cut_cells, cell, Vec3::Zero())) / cut_cells->h(cell);
  }
  Ring ring_of(int cell) const {
    const Grid& grid = cut_cells->grid;
    return is_axisymmetric() ? Ring{grid.plane_strain, grid.radial_axis(), diameter_of(cell)} : Ring{};
  }
  /// Returns Grid::ring in the middle of the face between a cell of one level (active or not) and the next one along a
  /// direction.
  double ring_of_face(const Index3& lower, int direction) const {
    Vec3 position = Vec3(lower[0], lower[1], lower[2]) + Vec3::Constant(0.5);
    position[direction] += 0.5;
    return cut_cells->grid.ring(position);
  }
  /// Returns whether a node (index into nodes) lies on the axis of revolution.
  bool is_on_axis(int node) const {
    const Grid& grid = cut_cells->grid;
    return grid.is_axisymmetric() &&
           std::abs(grid.radius(node_position(node))) < 0.25 * grid.cell_size_of(grid.num_levels - 1);
  }
  /// Returns whether a degree of freedom of a node (index into nodes) is zero: across plane strain, and on an axis of
  /// revolution away from it.
  bool is_zero(int node, int component) const {
    if (!is_one_layer()) return false;
    const Grid& grid = cut_cells->grid;
    return component == grid.plane_strain || (component == grid.radial_axis() && is_on_axis(node));
  }
  /// Returns whether a motion of the whole body (along the axes of the grid, then about them) is possible: in plane
  /// strain not along the axis nor about another one, of a body of revolution along its axis alone.
  bool moves(int motion) const {
    const Grid& grid = cut_cells->grid;
    if (!is_one_layer()) return true;
    if (is_axisymmetric()) return motion == grid.axis_of_revolution();
    return motion < 3 ? motion != grid.plane_strain : motion - 3 == grid.plane_strain;
  }
  /// Counts the free degrees of freedom: neither constrained nor zero by plane strain or an axis of revolution; the
  /// motions of a rigid body.
  int num_free_dofs() const;
  bool is_free(int node) const { return constraint_of_node.empty() || constraint_of_node[node] < 0; }
  /// Returns the number, among the nodes of all bodies, of the node at a position of the grid, or -1. A body of one
  /// level.
  int find_node(const Index3& position) const {
    const int node = node_numbers.find(position);
    return node < 0 ? -1 : first_node + node;
  }
  double poisson_ratio() const { return law.lambda / (2 * (law.lambda + law.mu)); }
};

/// Returns whether the face between two active cells carries the ghost penalty: where a cell is filled by less than a
/// quarter, which cannot hold its nodes by itself. On the faces of all cut cells the penalty costs a fifth more time
/// and gives nothing: docs/decisions.md, "Ghost penalty".
bool is_ghost_face(const BodyMesh& mesh, int e, int f);

/// Returns the virtual children of a level, one per face.
std::vector<Index3> virtual_cells(const BodyMesh& level);

/// Numbers the nodes and finds faces between levels, without the constraints; with levels, the body's own lists are
/// made if `joined`.
BodyMesh number_body_mesh(const CutCells& cut_cells, const Material& material, const Scales& scales, int first_node,
                          bool joined);

/// Makes the mesh of cells of one level, or of levels of descending (or equal) size; with levels, the body's own lists
/// are made if it has cells of its own beside those of its levels.
BodyMesh make_body_mesh(const CutCells& cut_cells, const Material& material, const Scales& scales, int first_node);

}  // namespace cgcontact
