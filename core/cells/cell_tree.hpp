/// Tree of the cells of a grid that are divided into eight: the levels of a locally refined grid, balanced so that
/// cells which touch, if only in a corner, differ by one level at most. The tree knows no body: leaves may be outside
/// of it.
#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "core/base/errors/errors.hpp"
#include "core/cells/grid.hpp"
#include "core/cells/grid_numbers.hpp"

namespace cgcontact {

class BodyGeometry;

/// A tree would have more cells than are allowed.
class TooManyCells : public InputError {
 public:
  using InputError::InputError;
};

class CellTree {
 public:
  /// Makes one level: no cell is refined.
  CellTree() = default;

  /// Divides refined[l]: cells of level l (size 2^-l) inside of the grid, and more where the balance asks for it: the
  /// parents of the 3 x 3 x 3 block round each of them exist only if divided. Throws InputError if a level has more
  /// cells per direction than 32-bit numbers hold.
  CellTree(const Index3& num_cells, const std::vector<std::vector<Index3>>& refined);

  int num_levels() const { return static_cast<int>(refined_.size()) + 1; }
  /// Returns whether a cell of a level is divided. Cells outside of the grid count as the nearest one inside.
  bool is_refined(int level, const Index3& cell) const {
    return level < static_cast<int>(refined_.size()) && refined_[level].find(clamped(level, cell)) >= 0;
  }
  /// Returns whether a cell of a level is a leaf. As above outside of the grid.
  bool is_leaf(int level, const Index3& cell) const {
    if (refined_.empty()) return level == 0;
    return !is_refined(level, cell) &&
           (level == 0 || is_refined(level - 1, {cell[0] >> 1, cell[1] >> 1, cell[2] >> 1}));
  }
  /// Returns whether a divided cell of a level touches a box. Unit of the coordinates: a cell of level 0.
  bool is_refined_in(int level, const Vec3& low, const Vec3& high) const;
  /// Returns the tree with every cell whose children are all leaves merged, as far as the balance allows: one level
  /// less.
  CellTree coarsened() const;
  /// Returns the divided cells of a level.
  const GridNumbers& refined(int level) const { return refined_[level]; }

 private:
  /// Looks at the cells `first` to `last` of level `from` and at their children.
  bool is_refined_in(int from, const Index3& first, const Index3& last, int level, const Vec3& low,
                     const Vec3& high) const;
  Index3 clamped(int level, Index3 cell) const;

  Index3 num_cells_{0, 0, 0};
  std::vector<GridNumbers> refined_;  ///< of every level but the last; none is empty
};

/// Counts the cells per direction of a level.
inline Index3 cells_of_level(const Index3& num_cells, int level) {
  return {num_cells[0] << level, num_cells[1] << level, num_cells[2] << level};
}

/// Divides cells that the body touches while they are larger than wanted somewhere in them; those of a quadtree
/// (Grid::slice) into four. body: grid coordinates. wanted(low, high): smallest wanted size in a box, grid coordinates.
/// max_levels >= 1. max_divided: TooManyCells as soon as more cells are divided, before their children are looked at.
CellTree refine_cells(const BodyGeometry& body, const Grid& grid,
                      const std::function<double(const Vec3& low, const Vec3& high)>& wanted, int max_levels,
                      double max_divided = std::numeric_limits<double>::infinity());

}  // namespace cgcontact
