/// Active cells of any size by position.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/cells/cut_cells.hpp"

namespace cgcontact {

/// Returns the active cell that contains a point (grid coordinates), or -1.
inline int cell_at(const CutCells& cc, const Vec3& position) {
  for (int level = cc.num_levels() - 1; level >= 0; --level) {
    const Vec3 x = std::ldexp(1.0, level) * position;
    const int cell = cc.find(level, {static_cast<int>(std::floor(x[0])), static_cast<int>(std::floor(x[1])),
                                     static_cast<int>(std::floor(x[2]))});
    if (cell >= 0) return cell;
  }
  return -1;
}

/// Returns the middle of an active cell, grid coordinates.
inline Vec3 middle_of_cell(const CutCells& cc, int cell) {
  return cc.corner(cell) + Vec3::Constant(0.5 * cc.size(cell));
}

/// Visits the active cells that overlap a box, from the cells of level 0 down to those they are divided into.
template <class Use>
class CellsInBox {
 public:
  CellsInBox(const CutCells& cc, const Vec3& low, const Vec3& high, const Use& use)
      : cc_(cc), low_(low), high_(high), use_(use) {
    visit(0, {0, 0, 0}, cc.grid.num_cells);
  }

 private:
  /// Visits the cells of a level from `first` to before `end`.
  void visit(int level, Index3 first, Index3 end) const {
    const double per_unit = std::ldexp(1.0, level);
    for (int d = 0; d < 3; ++d) {
      first[d] = std::max(first[d], static_cast<int>(std::floor(per_unit * low_[d])));
      end[d] = std::min(end[d], static_cast<int>(std::ceil(per_unit * high_[d])));
    }
    for (int k = first[2]; k < end[2]; ++k)
      for (int j = first[1]; j < end[1]; ++j)
        for (int i = first[0]; i < end[0]; ++i) {
          const Index3 cell{i, j, k};
          const int active = cc_.find(level, cell);
          if (active >= 0)
            use_(active);
          else if (cc_.tree && cc_.tree->is_refined(level, cell))
            visit(level + 1, {2 * i, 2 * j, 2 * k}, {2 * i + 2, 2 * j + 2, 2 * k + 2});
        }
  }

  const CutCells& cc_;
  const Vec3 low_, high_;
  const Use& use_;
};

/// Calls use(active cell) for the active cells that overlap a box (grid coordinates), each once.
template <class Use>
void each_cell_in(const CutCells& cc, const Vec3& low, const Vec3& high, const Use& use) {
  CellsInBox<Use>(cc, low, high, use);
}

/// Calls use(active cell) for those with their middle inside of it: no larger cells that reach out of it.
template <class Use>
void each_cell_within(const CutCells& cc, const Vec3& low, const Vec3& high, const Use& use) {
  each_cell_in(cc, low, high, [&](int cell) {
    const Vec3 middle = middle_of_cell(cc, cell);
    if ((middle.array() > low.array()).all() && (middle.array() < high.array()).all()) use(cell);
  });
}

}  // namespace cgcontact
