/// Columns of nodes through the thickness where a body is thin: all nodes of a grid line between two surfaces, if there
/// are no more than five. The smoother inverts them as one block: across a thin body the nodes hang together much more
/// firmly than along it (slivers, supports on both sides, cells that are wider than the body is thick).
#pragma once

#include <vector>

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
    /// Place in `matrices` of an entry of the column's matrix.
    KOKKOS_INLINE_FUNCTION std::size_t entry(int row, int col) const { return matrix + row * dof_of(size) + col; }
  };
  Kokkos::View<Column*, MemSpace> columns;  ///< ascending in size
  IntView nodes;
  IntView column_of_node;                  ///< (nodes of all bodies) -1: in no column
  int size_begin[longest + 2] = {};        ///< first column with as many nodes
  Kokkos::View<Real*, MemSpace> matrices;  ///< (3 size) x (3 size) of each column, row-major, DoFs node by node

  int num_columns() const { return static_cast<int>(columns.extent(0)); }
  /// Position of a node in its column.
  KOKKOS_INLINE_FUNCTION int place(const Column& column, int node) const {
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

}  // namespace cgcontact
