#include "kernels/mesh/hanging_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "kernels/mesh/sparse_rows.hpp"

namespace cgcontact {
namespace {

/// Returns whether a node of the level is a corner of one of its active cells.
bool is_corner(const BodyMesh& level, const Index3& position) {
  for (int a = 0; a < 8; ++a)
    if (level.cut_cells->find({position[0] - (a & 1), position[1] - (a >> 1 & 1), position[2] - (a >> 2)}) >= 0)
      return true;
  return false;
}

/// Returns the active cell of a level that has a point in or on it; `twice`: its position in half cells. -1: none.
int cell_around(const BodyMesh& level, const Index3& twice) {
  for (int a = 0; a < 8; ++a) {
    Index3 cell;
    bool across_node = false;  // inside of a layer of cells there is one cell, not two
    for (int d = 0; d < 3; ++d) {
      const int lower = a >> d & 1;
      across_node = across_node || (lower && (twice[d] & 1));
      cell[d] = (twice[d] >> 1) - lower;
    }
    if (across_node) continue;
    if (const int found = level.cut_cells->find(cell); found >= 0) return found;
  }
  return -1;
}

class Constrainer {
 public:
  explicit Constrainer(const std::vector<BodyMesh>& levels) : levels_(levels) {
    of_node_.assign(levels.back().first_node + levels.back().num_nodes - levels.front().first_node, -1);
  }

  std::vector<NodeConstraint> run() {
    const int axis = levels_.front().cut_cells->grid.plane_strain;
    for (std::size_t p = axis < 0 ? 1 : 0; p < levels_.size(); ++p)
      for (int n = 0; n < levels_[p].num_nodes; ++n)
        if (axis < 0 || levels_[p].nodes[n][axis] == 0)
          constrain(p, n);
        else
          constrain_across(levels_[p], n, axis);
    return std::move(constraints_);
  }

 private:
  /// To what the node opposite, which comes before it, is: itself or its masters.
  void constrain_across(const BodyMesh& level, int n, int axis) {
    Index3 opposite = level.nodes[n];
    if (--opposite[axis] != 0) throw std::logic_error("plane strain: more than one layer of cells");
    add(level.first_node + n, {{level.find_node(opposite), 1.0}});
  }

  void constrain(std::size_t p, int n) {
    const BodyMesh& level = levels_[p];
    const Index3& position = level.nodes[n];
    const bool own = is_corner(level, position);
    for (std::size_t q = 0; q < p; ++q) {
      const int steps = halvings(levels_[q].cut_cells->grid, level.cut_cells->grid), size = 1 << steps;
      if (position[0] % size == 0 && position[1] % size == 0 && position[2] % size == 0) {
        const Index3 at{position[0] >> steps, position[1] >> steps, position[2] >> steps};
        if (const int node = levels_[q].find_node(at); node >= 0 && is_corner(levels_[q], at))
          return add(level.first_node + n, {{node, 1.0}});
      }
      if (steps != 1) continue;
      if (const int cell = cell_around(levels_[q], position); cell >= 0)
        return add(level.first_node + n, corners(levels_[q], cell, position));
    }
    if (!own) throw std::logic_error("a node of a virtual cell lies in no cell");
  }

  /// Interpolates at a position (in half cells) of a cell: the mean of the corners on the smallest side it lies on.
  static SparseRow corners(const BodyMesh& level, int cell, const Index3& twice) {
    const Index3& c = level.cut_cells->cells[cell];
    SparseRow row;
    for (int a = 0; a < 8; ++a) {
      double weight = 1;
      for (int d = 0; d < 3; ++d) {
        const int at = twice[d] - 2 * c[d], side = a >> d & 1;  // 0, 1, 2: along the cell
        weight *= at == 1 ? 0.5 : at == 2 * side ? 1 : 0;
      }
      if (weight > 0) row.emplace_back(level.cell_nodes[cell][a], weight);
    }
    return row;
  }

  void add(int node, const SparseRow& row) {
    NodeConstraint constraint{node, {}};
    for (const auto& [master, weight] : row) {
      const int c = of_node_[master - levels_.front().first_node];
      if (c < 0) {
        constraint.masters.emplace_back(master, weight);
        continue;
      }
      for (const auto& [next, share] : constraints_[c].masters) constraint.masters.emplace_back(next, weight * share);
    }
    std::sort(constraint.masters.begin(), constraint.masters.end());
    SparseRow merged;
    for (const auto& [master, weight] : constraint.masters)
      if (!merged.empty() && merged.back().first == master)
        merged.back().second += weight;
      else
        merged.emplace_back(master, weight);
    constraint.masters = std::move(merged);
    of_node_[node - levels_.front().first_node] = static_cast<int>(constraints_.size());
    constraints_.push_back(std::move(constraint));
  }

  const std::vector<BodyMesh>& levels_;
  std::vector<NodeConstraint> constraints_;
  std::vector<int> of_node_;
};

}  // namespace

int halvings(const Grid& larger, const Grid& smaller) {
  return static_cast<int>(std::lround(std::log2(larger.cell_size / smaller.cell_size)));
}

std::vector<NodeConstraint> constrain_nodes(const std::vector<BodyMesh>& levels) { return Constrainer(levels).run(); }

std::vector<NodeConstraint> constrain_across(const BodyMesh& mesh) {
  const int axis = mesh.cut_cells->grid.plane_strain, layer = mesh.cut_cells->cells.front()[axis];
  for (const Index3& cell : mesh.cut_cells->cells)
    if (cell[axis] != layer) throw std::logic_error("plane strain: more than one layer of cells");
  std::vector<NodeConstraint> constraints;
  for (int n = 0; n < mesh.num_nodes; ++n) {
    Index3 opposite = mesh.nodes[n];
    if (opposite[axis]-- == layer) continue;
    constraints.push_back({mesh.first_node + n, {{mesh.find_node(opposite), 1.0}}});
  }
  return constraints;
}

}  // namespace cgcontact
