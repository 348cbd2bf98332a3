/// Rows of contact groups and supports on the host, from which a smoother's arrays and its surface matrix are made.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "kernels/operator/node_columns.hpp"
#include "kernels/operator/system.hpp"

namespace cgcontact {

/// With the symbols of SurfaceSmoother: k^1/2 B and W, by rows and by touched nodes. A row has entries at its own
/// nodes, and at the rest of the columns that they are in.
struct SurfaceRows {
  std::vector<int> begin{0}, node;  ///< row -> entries; the node of each, ascending in a row
  std::vector<Vec3> b, w;           ///< of each entry: of k^1/2 B, of W

  // Set by sort_by_nodes.
  std::vector<int> touched_nodes, touched;  ///< nodes with entries; number of each node among them, -1: none
  std::vector<int> node_begin{0};           ///< touched node -> places in the next two
  std::vector<int> node_row, node_entry;    ///< row and number of its entries

  int num_rows() const { return static_cast<int>(begin.size()) - 1; }
  /// Adds a row, unless its stiffness is zero. inverse: block of D^-1 of a node in no column, whose inverses `columns`
  /// has.
  template <class Real>
  void add(const GroupRow& row, double stiffness, const NodeColumns<Real>& columns,
           const std::function<Mat3(int node)>& inverse);
  /// Sorts the entries of all rows by nodes.
  void sort_by_nodes(int num_nodes);

 private:
  template <class Real>
  void add_rest_of_columns(const NodeColumns<Real>& columns);
  template <class Real>
  void add_w_of_column(const NodeColumns<Real>& columns, int number);

  // The row that is being added.
  std::vector<std::pair<int, Vec3>> entries_;  ///< node, of k^1/2 B
  std::vector<int> columns_;                   ///< that its nodes are in
};

}  // namespace cgcontact
