#include "core/cells/cells_around.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

namespace cgcontact {
namespace {

/// Index in units of the smallest cells. Blocks go from one up to another, which they do not hold.
using FineIndex = std::array<long long, 3>;
struct FineBlock {
  FineIndex from, to;
};

bool overlap(const FineBlock& a, const FineBlock& b) {
  for (int d = 0; d < 3; ++d)
    if (a.from[d] >= b.to[d] || b.from[d] >= a.to[d]) return false;
  return true;
}
/// Returns whether a block is outside of the grid.
bool is_empty(const FineBlock& a) { return a.from[0] >= a.to[0] || a.from[1] >= a.to[1] || a.from[2] >= a.to[2]; }
bool contains(const FineBlock& outer, const FineBlock& inner) {
  for (int d = 0; d < 3; ++d)
    if (inner.from[d] < outer.from[d] || inner.to[d] > outer.to[d]) return false;
  return true;
}

/// Marks what overlaps some blocks, from above: from blocks of the whole grid to its cells and their children, as deep
/// as they differ. The time of a block goes with the cells in it.
class Marking {
 public:
  Marking(const CutCells& cells, std::vector<char>& marked) : cells_(cells), marked_(marked) {}

  /// Marks blocks at an index; size: log2 of its cells, level 0; below 0 their children.
  void mark(int size, const Index3& index, const std::vector<FineBlock>& blocks) {
    const FineBlock here = block_of(size, index);
    if (is_empty(here)) return;
    std::vector<FineBlock> those;
    for (const FineBlock& block : blocks) {
      if (contains(block, here)) return mark_all(size, index);
      if (overlap(block, here)) those.push_back(block);
    }
    if (those.empty()) return;
    if (size <= 0) {
      if (const int found = cells_.find(-size, index); found >= 0) {
        marked_[found] = 1;
        return;
      }
      if (!cells_.tree || !cells_.tree->is_refined(-size, index)) return;
    }
    each_child(index, [&](const Index3& child) { mark(size - 1, child, those); });
  }

 private:
  /// Returns the block at an index within the grid.
  FineBlock block_of(int size, const Index3& index) const {
    FineBlock block;
    const int units = size + cells_.num_levels() - 1;
    for (int d = 0; d < 3; ++d) {
      const long long end = static_cast<long long>(cells_.grid.num_cells[d]) << (cells_.num_levels() - 1);
      block.from[d] = static_cast<long long>(index[d]) << units;
      block.to[d] = std::min(static_cast<long long>(index[d] + 1) << units, end);
    }
    return block;
  }

  void mark_all(int size, const Index3& index) {
    if (is_empty(block_of(size, index))) return;
    if (size <= 0) return each_cell_at(cells_, {-size, index}, [&](int cell) { marked_[cell] = 1; });
    each_child(index, [&](const Index3& child) { mark_all(size - 1, child); });
  }

  template <class Use>
  static void each_child(const Index3& index, const Use& use) {
    for (int a = 0; a < 8; ++a) use({2 * index[0] + (a & 1), 2 * index[1] + (a >> 1 & 1), 2 * index[2] + (a >> 2)});
  }

  const CutCells& cells_;
  std::vector<char>& marked_;
};

}  // namespace

void mark_cells_around(const CutCells& cells, const std::vector<int>& active, int reach, std::vector<char>& marked) {
  std::vector<FineBlock> blocks;
  for (const int cell : active) {
    FineBlock block;
    const int units = cells.num_levels() - 1 - cells.level(cell);
    for (int d = 0; d < 3; ++d) {
      const long long index = cells.cells[cell][d];
      block.from[d] = (index - reach) * (1LL << units);
      block.to[d] = (index + reach + 1) * (1LL << units);
    }
    blocks.push_back(block);
  }
  int size = 0;
  for (const int n : cells.grid.num_cells)
    while (1 << size < n) ++size;
  Marking(cells, marked).mark(size, {0, 0, 0}, blocks);
}

namespace {

/// Cells in sets, of which the least one stands for the set.
class JoinedCells {
 public:
  explicit JoinedCells(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int least(int cell) {
    while (parent_[cell] != cell) cell = parent_[cell] = parent_[parent_[cell]];
    return cell;
  }
  void join(int a, int b) {
    const auto [low, high] = std::minmax({least(a), least(b)});
    parent_[high] = low;
  }

 private:
  std::vector<int> parent_;
};

/// Calls use(first, length) for the runs of bits that are set.
template <class Use>
void each_run(std::uint64_t bits, const Use& use) {
  while (bits != 0) {
    const int first = __builtin_ctzll(bits);
    const std::uint64_t from_there =
        ~(bits >> first);  // 64 positions from the lowest bit: no end of the run among them
    const int length = from_there == 0 ? 64 : __builtin_ctzll(from_there);
    use(first, length);
    if (first + length == 64) return;
    bits &= ~std::uint64_t{0} << (first + length);
  }
}

Index3 moved(Index3 index, int direction, int by) {
  index[direction] += by;
  return index;
}

/// Joins the cells of a level with each other and with those of twice the size beside them. By words of 64 cells: runs
/// that touch are connected.
void join_level(const CutCells& cells, int level, JoinedCells& joined) {
  const GridNumbers& numbers = cells.level_cells.empty() ? cells.numbers : cells.level_cells[level].numbers;
  numbers.each_word([&](const Index3& first, std::uint64_t bits, int) {
    const auto cell_at = [&](int bit, int direction = 0, int by = 0) {
      return cells.find(level, moved(moved(first, 0, bit), direction, by));
    };
    each_run(bits, [&](int begin, int length) {
      const int cell = cell_at(begin);  // numbers go up by one along x
      for (int i = 1; i < length; ++i) joined.join(cell, cell + i);
      const int next = cell_at(begin + length);  // in the next word, if the run goes on there
      if (next >= 0) joined.join(cell, next);
    });
    for (const int d : {1, 2})
      each_run(bits & numbers.bits(moved(first, d, 1)),
               [&](int begin, int) { joined.join(cell_at(begin), cell_at(begin, d, 1)); });
    if (level == 0) return;
    for (int d = 0; d < 3; ++d)
      for (const int side : {-1, 1})
        for (std::uint64_t alone = bits & ~numbers.bits(moved(first, d, side)); alone != 0; alone &= alone - 1) {
          Index3 larger = moved(moved(first, 0, __builtin_ctzll(alone)), d, side);
          for (int& c : larger) c >>= 1;
          const int found = cells.find(level - 1, larger);
          if (found >= 0) joined.join(cell_at(__builtin_ctzll(alone)), found);
        }
  });
}

}  // namespace

std::vector<int> find_connected_components(const CutCells& cells, int& count) {
  JoinedCells joined(cells.cells.size());
  for (int level = 0; level < cells.num_levels(); ++level) join_level(cells, level, joined);
  std::vector<int> component(cells.cells.size());
  count = 0;
  for (int cell = 0; cell < static_cast<int>(component.size()); ++cell) {
    const int least = joined.least(cell);
    component[cell] = least == cell ? count++ : component[least];
  }
  return component;
}

}  // namespace cgcontact
