#include "core/cells/cells_around.hpp"

namespace cgcontact {
namespace {

/// Grows a set of places along all axes; each comes once.
void grow(std::vector<Index3>& places, int reach) {
  std::vector<Index3> grown;
  for (int axis = 0; axis < 3; ++axis) {
    // Line by line along the axis.
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    std::sort(places.begin(), places.end(), [&](const Index3& x, const Index3& y) {
      return std::tie(x[c], x[b], x[axis]) < std::tie(y[c], y[b], y[axis]);
    });
    grown.clear();
    for (Index3 place : places) {
      const int last = place[axis] + reach;
      place[axis] -= reach;
      if (!grown.empty() && grown.back()[b] == place[b] && grown.back()[c] == place[c])
        place[axis] = std::max(place[axis], grown.back()[axis] + 1);
      for (; place[axis] <= last; ++place[axis]) grown.push_back(place);
    }
    places.swap(grown);
  }
}

}  // namespace

void mark_cells_around(const CutCells& cells, const std::vector<int>& active, int reach, std::vector<char>& marked) {
  for (int l = 0; l < cells.num_levels(); ++l) {
    std::vector<Index3> places;
    for (const int cell : active)
      if (cells.level(cell) == l) places.push_back(cells.cells[cell]);
    grow(places, reach);
    for (const Index3& place : places) each_cell_at(cells, {l, place}, [&](int cell) { marked[cell] = 1; });
  }
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
