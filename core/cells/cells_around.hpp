/// Cells around a cell, also where levels meet.
#pragma once

#include <algorithm>
#include <vector>

#include "core/cells/cut_cells.hpp"

namespace cgcontact {

/// Index of a cell: its level and its indices there.
struct CellIndex {
  int level = 0;
  Index3 cell{0, 0, 0};
  bool operator<(const CellIndex& o) const { return std::tie(level, cell) < std::tie(o.level, o.cell); }
};

inline CellIndex cell_index(const CutCells& cells, int active) { return {cells.level(active), cells.cells[active]}; }

/// Calls use(CellIndex) for the indices of all cells up to `reach` cells of its size away from a cell: of its level
/// and of the next larger and smaller ones, which may touch it. Larger ones may come several times.
template <class Use>
void each_cell_index_around(int num_levels, const CellIndex& index, int reach, const Use& use) {
  const Index3& c = index.cell;
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      for (int k = -reach; k <= reach; ++k) {
        const Index3 at{c[0] + i, c[1] + j, c[2] + k};
        use(CellIndex{index.level, at});
        if (index.level > 0) use(CellIndex{index.level - 1, {at[0] >> 1, at[1] >> 1, at[2] >> 1}});
        if (index.level + 1 < num_levels)
          for (int a = 0; a < 8; ++a)
            use(CellIndex{index.level + 1, {2 * at[0] + (a & 1), 2 * at[1] + (a >> 1 & 1), 2 * at[2] + (a >> 2)}});
      }
}

/// Calls use(active cell) for the active cells that overlap a cell of a level: the one that contains it, or all in it.
template <class Use>
void each_cell_at(const CutCells& cells, const CellIndex& index, const Use& use) {
  Index3 c = index.cell;
  for (int l = index.level; l >= 0; --l) {
    if (const int found = cells.find(l, c); found >= 0) return use(found);
    for (int& x : c) x >>= 1;
  }
  if (!cells.tree) return;
  const Index3 end = cells_of_level(cells.grid.num_cells, index.level);
  for (int d = 0; d < 3; ++d)
    if (index.cell[d] < 0 || index.cell[d] >= end[d]) return;
  if (!cells.tree->is_refined(index.level, index.cell)) return;
  c = index.cell;
  for (int a = 0; a < 8; ++a)
    each_cell_at(cells, {index.level + 1, {2 * c[0] + (a & 1), 2 * c[1] + (a >> 1 & 1), 2 * c[2] + (a >> 2)}}, use);
}

/// Calls use(active cell) for the active cells on the other sides of a cell's faces.
template <class Use>
void each_cell_beside(const CutCells& cells, int active, const Use& use) {
  const int level = cells.level(active);
  for (int f = 0; f < 6; ++f) {
    const int d = f / 2, side = f % 2;
    Index3 next = cells.cells[active];
    next[d] += side == 0 ? -1 : 1;
    const auto take = [&](int l, const Index3& at) {
      const int found = cells.find(l, at);
      if (found >= 0) use(found);
    };
    take(level, next);
    if (level > 0) take(level - 1, {next[0] >> 1, next[1] >> 1, next[2] >> 1});
    if (level + 1 >= cells.num_levels()) continue;
    for (int a = 0; a < 8; ++a)
      if ((a >> d & 1) != side)
        take(level + 1, {2 * next[0] + (a & 1), 2 * next[1] + (a >> 1 & 1), 2 * next[2] + (a >> 2)});
  }
}

/// Marks the active cells that overlap the blocks of 2 reach + 1 cells per direction around some active cells, in cells
/// of their sizes. marked: one entry per active cell.
void mark_cells_around(const CutCells& cells, const std::vector<int>& active, int reach, std::vector<char>& marked);

/// Returns the index of the connected component of every active cell (joined by common faces), from 0, and their count.
std::vector<int> find_connected_components(const CutCells& cells, int& count);

}  // namespace cgcontact
