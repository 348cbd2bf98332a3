/// Some of a body's cells or nodes, numbered through: arrays that are needed for those only have one row for each.
#pragma once

#include <cstddef>
#include <vector>

namespace cgcontact {

class Subset {
 public:
  /// Selects all of `total`.
  explicit Subset(int total = 0) : size_(total) {}
  /// Selects those marked.
  explicit Subset(const std::vector<char>& marked) : row_(marked.size(), -1) {
    for (std::size_t n = 0; n < marked.size(); ++n)
      if (marked[n]) {
        row_[n] = static_cast<int>(number_.size());
        number_.push_back(static_cast<int>(n));
      }
    size_ = static_cast<int>(number_.size());
  }

  int size() const { return size_; }
  int number(int row) const { return row_.empty() ? row : number_[row]; }
  /// Returns -1 if it is not in the subset.
  int row(int number) const { return row_.empty() ? number : row_[number]; }

  const std::vector<int>& numbers() const { return number_; }  ///< by row; empty: all
  const std::vector<int>& rows() const { return row_; }        ///< by number; empty: all

 private:
  int size_ = 0;
  std::vector<int> number_, row_;  ///< empty: all
};

}  // namespace cgcontact
