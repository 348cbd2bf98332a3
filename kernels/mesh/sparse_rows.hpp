/// Sparse rows on the host (numbers with coefficients), compressed, and their transpose.
#pragma once

#include <map>
#include <utility>
#include <vector>

namespace cgcontact {

using SparseRow = std::vector<std::pair<int, double>>;  ///< (number, coefficient)

/// Rows in turn: those of row i are begin[i] .. begin[i + 1] - 1.
struct CompressedRows {
  std::vector<int> begin{0}, number;
  std::vector<double> coefficient;

  void add(const SparseRow& row) {
    for (const auto& [n, c] : row) {
      number.push_back(n);
      coefficient.push_back(c);
    }
    begin.push_back(static_cast<int>(number.size()));
  }
};

/// The columns that are not empty, ascending; in each the rows in the order in which they came.
struct TransposedRows {
  std::vector<int> column;
  CompressedRows rows;
};

/// Compresses rows; row_at(i): the SparseRow i, which is called label(i) in the transpose.
template <class RowAt, class Label>
std::pair<CompressedRows, TransposedRows> compress_rows(std::size_t num_rows, const RowAt& row_at, const Label& label) {
  std::pair<CompressedRows, TransposedRows> result;
  std::map<int, SparseRow> columns;
  for (std::size_t i = 0; i < num_rows; ++i) {
    const SparseRow& row = row_at(i);
    result.first.add(row);
    for (const auto& [n, c] : row) columns[n].emplace_back(label(i), c);
  }
  for (const auto& [n, entries] : columns) {
    result.second.column.push_back(n);
    result.second.rows.add(entries);
  }
  return result;
}

}  // namespace cgcontact
