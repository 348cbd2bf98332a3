/// Columns of nodes through the thickness where a body is thin: all nodes of a grid line between two surfaces, five at
/// most. The smoother inverts them as one block: across a thin body nodes are coupled much more firmly than along it
/// (slivers, supports on both sides, cells wider than the body is thick).
#pragma once

#include <vector>

#include "kernels/mesh/host_copy.hpp"
#include "kernels/operator/system.hpp"

namespace cgcontact {

template <class Real>
struct NodeColumns {
  static constexpr int longest = 5;
  struct Column {
    int body, axis;
    int size;            ///< nodes
    int first;           ///< position of the first node in `nodes`, ascending along the axis
    std::size_t matrix;  ///< first entry in `matrices`
    /// Returns the index in `matrices` of an entry of the column's matrix.
    KOKKOS_INLINE_FUNCTION std::size_t entry(int row, int col) const { return matrix + row * dof_of(size) + col; }
  };
  Kokkos::View<Column*, MemSpace> columns;  ///< ascending in size
  IntView nodes;
  IntView column_of_node;                  ///< (nodes of all bodies) -1: in no column
  int size_begin[longest + 2] = {};        ///< first column with as many nodes
  Kokkos::View<Real*, MemSpace> matrices;  ///< (3 size) x (3 size) of each column, row-major, DoFs node by node

  int num_columns() const { return static_cast<int>(columns.extent(0)); }
  /// Position of a node in its column.
  KOKKOS_INLINE_FUNCTION int slot(const Column& column, int node) const {
    int p = 0;
    while (nodes(column.first + p) != node) ++p;
    return p;
  }
  std::size_t bytes() const;
};

/// A node belongs to the shortest grid line through it, if that has not lost a node to a shorter one and none of its
/// nodes is constrained. Matrices are
/// zero.
template <class Real>
NodeColumns<Real> make_node_columns(const ElasticSystem& system);

/// Returns the nodes of each column.
template <class Real>
std::vector<std::vector<int>> nodes_of_columns(const NodeColumns<Real>& columns);

/// Returns the columns of one rank in its numbers: those whose nodes it owns (local(node) >= 0; a column has one
/// owner). Matrices are zero.
template <class Real, class Local>
NodeColumns<Real> columns_of_rank(const NodeColumns<Real>& columns, int num_nodes, const Local& local) {
  using Columns = NodeColumns<Real>;
  std::vector<int> column_of_node(num_nodes, -1), nodes;
  std::vector<typename Columns::Column> own;
  std::size_t entries = 0;
  Columns result;
  for (int size = 2; size <= Columns::longest; ++size) {
    result.size_begin[size] = static_cast<int>(own.size());
    for (int c = columns.size_begin[size]; c < columns.size_begin[size + 1]; ++c) {
      typename Columns::Column column = columns.columns(c);
      if (local(columns.nodes(column.first)) < 0) continue;
      const int first = static_cast<int>(nodes.size());
      for (int p = 0; p < size; ++p) {
        nodes.push_back(local(columns.nodes(column.first + p)));
        column_of_node[nodes.back()] = static_cast<int>(own.size());
      }
      column.first = first;
      column.matrix = entries;
      own.push_back(column);
      entries += dof_offset(size) * dof_offset(size);
    }
  }
  result.size_begin[Columns::longest + 1] = static_cast<int>(own.size());
  result.columns = copy_to_view<decltype(result.columns)>("cgcontact::node_columns::columns", own);
  result.nodes = copy_to_view<IntView>("cgcontact::node_columns::nodes", nodes);
  result.column_of_node = copy_to_view<IntView>("cgcontact::node_columns::column_of_node", column_of_node);
  result.matrices = decltype(result.matrices)("cgcontact::node_columns::matrices", entries);
  return result;
}

}  // namespace cgcontact
