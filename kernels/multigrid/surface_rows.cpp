#include "kernels/multigrid/surface_rows.hpp"

#include <algorithm>
#include <cmath>

namespace cgcontact {

template <class Real>
void SurfaceRows::add(const GroupRow& row, double stiffness, const NodeColumns<Real>& columns,
                      const std::function<Mat3(int)>& inverse) {
  if (stiffness <= 0) return;
  entries_.clear();
  columns_.clear();
  const double root = std::sqrt(stiffness);
  for (const auto& [dof, value] : row.entries) {
    const int n = node_of_dof(dof);
    if (entries_.empty() || entries_.back().first != n) {
      entries_.emplace_back(n, Vec3::Zero());
      if (columns.column_of_node(n) >= 0) columns_.push_back(columns.column_of_node(n));
    }
    entries_.back().second[component_of_dof(dof)] = root * value;
  }
  std::sort(columns_.begin(), columns_.end());
  columns_.erase(std::unique(columns_.begin(), columns_.end()), columns_.end());
  add_rest_of_columns(columns);
  for (const auto& [n, of_node] : entries_) {
    node.push_back(n);
    b.push_back(of_node);
    w.push_back(columns.column_of_node(n) < 0 ? Vec3(inverse(n) * of_node) : Vec3(Vec3::Zero()));
  }
  for (const int c : columns_) add_w_of_column(columns, c);
  begin.push_back(static_cast<int>(node.size()));
}

/// Appends the nodes of the row's columns that its entries, whose nodes ascend, do not have yet.
template <class Real>
void SurfaceRows::add_rest_of_columns(const NodeColumns<Real>& columns) {
  const auto own = static_cast<std::ptrdiff_t>(entries_.size());
  const auto has = [&](int n) {
    const auto end = entries_.begin() + own;
    const auto e = std::lower_bound(entries_.begin(), end, n, [](const auto& entry, int x) { return entry.first < x; });
    return e != end && e->first == n;
  };
  for (const int c : columns_) {
    const auto& column = columns.columns(c);
    for (int p = 0; p < column.size; ++p)
      if (const int n = columns.nodes(column.first + p); !has(n)) entries_.emplace_back(n, Vec3::Zero());
  }
  std::sort(entries_.begin(), entries_.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
}

/// Adds W at a column's nodes in the last row, whose end is not set yet.
template <class Real>
void SurfaceRows::add_w_of_column(const NodeColumns<Real>& columns, int number) {
  const auto position_of = [&](int n) {
    return std::lower_bound(node.begin() + begin.back(), node.end(), n) - node.begin();
  };
  const auto& column = columns.columns(number);
  for (int p = 0; p < column.size; ++p)
    for (int q = 0; q < column.size; ++q) {
      const Vec3& from = b[position_of(columns.nodes(column.first + q))];
      Vec3& to = w[position_of(columns.nodes(column.first + p))];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) to[i] += columns.matrices(column.entry(dof_of(p, i), dof_of(q, j))) * from[j];
    }
}

void SurfaceRows::sort_by_nodes(int num_nodes) {
  std::vector<int> count(num_nodes, 0);
  for (const int n : node) ++count[n];
  touched.assign(num_nodes, -1);
  for (int n = 0; n < num_nodes; ++n) {
    if (count[n] == 0) continue;
    touched[n] = static_cast<int>(touched_nodes.size());
    touched_nodes.push_back(n);
    node_begin.push_back(node_begin.back() + count[n]);
  }
  node_row.resize(node.size());
  node_entry.resize(node.size());
  std::vector<int> position(node_begin.begin(), node_begin.end());
  for (int r = 0; r < num_rows(); ++r)
    for (int e = begin[r]; e < begin[r + 1]; ++e) {
      const int p = position[touched[node[e]]]++;
      node_row[p] = r;
      node_entry[p] = e;
    }
}

template void SurfaceRows::add(const GroupRow&, double, const NodeColumns<float>&, const std::function<Mat3(int)>&);
template void SurfaceRows::add(const GroupRow&, double, const NodeColumns<double>&, const std::function<Mat3(int)>&);

}  // namespace cgcontact
