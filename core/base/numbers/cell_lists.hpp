/// Lists of numbers, one per cell (or node), in two arrays.
#pragma once

#include <cstddef>
#include <vector>

namespace cgcontact {

class CellLists {
 public:
  struct Range {
    const int *first, *last;
    const int* begin() const { return first; }
    const int* end() const { return last; }
    std::size_t size() const { return static_cast<std::size_t>(last - first); }
    bool empty() const { return first == last; }
  };

  CellLists() = default;
  /// Lists for cell c the i with cell_of_item[i] == c, ascending.
  CellLists(std::size_t num_cells, const std::vector<int>& cell_of_item)
      : begin_(num_cells + 1, 0), items_(cell_of_item.size()) {
    for (int c : cell_of_item) ++begin_[c + 1];
    for (std::size_t c = 0; c < num_cells; ++c) begin_[c + 1] += begin_[c];
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < cell_of_item.size(); ++i) items_[next[cell_of_item[i]]++] = static_cast<int>(i);
  }

  /// Returns the list; empty for all cells if nothing was given.
  Range operator[](int cell) const {
    if (begin_.empty()) return {nullptr, nullptr};
    return {items_.data() + begin_[cell], items_.data() + begin_[cell + 1]};
  }

 private:
  std::vector<int> begin_, items_;
};

}  // namespace cgcontact
