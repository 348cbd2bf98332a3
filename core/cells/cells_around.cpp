#include "core/cells/cells_around.hpp"

#include <array>

namespace cgcontact {
namespace {

/// Places in units of the smallest cells, from and up to; none holds its end.
using Place = std::array<long long, 3>;
struct Block {
  Place from, to;
};

bool overlap(const Block& a, const Block& b) {
  for (int d = 0; d < 3; ++d)
    if (a.from[d] >= b.to[d] || b.from[d] >= a.to[d]) return false;
  return true;
}
/// Tells whether a block is outside of the grid.
bool is_empty(const Block& a) { return a.from[0] >= a.to[0] || a.from[1] >= a.to[1] || a.from[2] >= a.to[2]; }
bool contains(const Block& outer, const Block& inner) {
  for (int d = 0; d < 3; ++d)
    if (inner.from[d] < outer.from[d] || inner.to[d] > outer.to[d]) return false;
  return true;
}

/// Marks what overlaps some blocks, from above: from blocks of the whole grid to its cells and their parts, as deep as
/// there is something to tell apart. So a block of any number of small cells takes no longer than the cells in it.
class Marking {
 public:
  Marking(const CutCells& cells, std::vector<char>& marked) : cells_(cells), marked_(marked) {}

  /// size: log2 of that of the place, cells of level 0; below 0 parts of them.
  void mark(int size, const Index3& place, const std::vector<Block>& blocks) {
    const Block here = block_of(size, place);
    if (is_empty(here)) return;
    std::vector<Block> those;
    for (const Block& block : blocks) {
      if (contains(block, here)) return mark_all(size, place);
      if (overlap(block, here)) those.push_back(block);
    }
    if (those.empty()) return;
    if (size <= 0) {
      if (const int found = cells_.find(-size, place); found >= 0) {
        marked_[found] = 1;
        return;
      }
      if (!cells_.tree || !cells_.tree->is_refined(-size, place)) return;
    }
    each_part(place, [&](const Index3& part) { mark(size - 1, part, those); });
  }

 private:
  /// The part of a place that is in the grid.
  Block block_of(int size, const Index3& place) const {
    Block block;
    const int units = size + cells_.num_levels() - 1;
    for (int d = 0; d < 3; ++d) {
      const long long end = static_cast<long long>(cells_.grid.num_cells[d]) << (cells_.num_levels() - 1);
      block.from[d] = static_cast<long long>(place[d]) << units;
      block.to[d] = std::min(static_cast<long long>(place[d] + 1) << units, end);
    }
    return block;
  }

  void mark_all(int size, const Index3& place) {
    if (is_empty(block_of(size, place))) return;
    if (size <= 0) return each_cell_at(cells_, {-size, place}, [&](int cell) { marked_[cell] = 1; });
    each_part(place, [&](const Index3& part) { mark_all(size - 1, part); });
  }

  template <class Use>
  static void each_part(const Index3& place, const Use& use) {
    for (int a = 0; a < 8; ++a) use({2 * place[0] + (a & 1), 2 * place[1] + (a >> 1 & 1), 2 * place[2] + (a >> 2)});
  }

  const CutCells& cells_;
  std::vector<char>& marked_;
};

}  // namespace

void mark_cells_around(const CutCells& cells, const std::vector<int>& active, int reach, std::vector<char>& marked) {
  std::vector<Block> blocks;
  for (const int cell : active) {
    Block block;
    const int units = cells.num_levels() - 1 - cells.level(cell);
    for (int d = 0; d < 3; ++d) {
      const long long place = cells.cells[cell][d];
      block.from[d] = (place - reach) * (1LL << units);
      block.to[d] = (place + reach + 1) * (1LL << units);
    }
    blocks.push_back(block);
  }
  int size = 0;
  for (const int n : cells.grid.num_cells)
    while (1 << size < n) ++size;
  Marking(cells, marked).mark(size, {0, 0, 0}, blocks);
}

std::vector<int> find_connected_pieces(const CutCells& cells, int& count) {
  std::vector<int> piece(cells.cells.size(), -1), waiting;
  count = 0;
  for (std::size_t start = 0; start < piece.size(); ++start) {
    if (piece[start] >= 0) continue;
    piece[start] = count;
    waiting.push_back(static_cast<int>(start));
    while (!waiting.empty()) {
      const int cell = waiting.back();
      waiting.pop_back();
      each_cell_beside(cells, cell, [&](int neighbour) {
        if (piece[neighbour] >= 0) return;
        piece[neighbour] = count;
        waiting.push_back(neighbour);
      });
    }
    ++count;
  }
  return piece;
}

}  // namespace cgcontact
