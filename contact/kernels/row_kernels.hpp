/// Rows of the mean gap change of contact groups: how far the unknowns of both bodies separate the points of a group,
/// weighted by area. Counted, scanned, filled; the contributions to one unknown are added in the order of the points,
/// so that rows are bitwise the same on any number of threads.
#pragma once

#include <array>

#include "contact/kernels/contact_points.hpp"
#include "contact/kernels/group_kernels.hpp"
#include "kernels/mesh/dofs.hpp"
#include "kernels/mesh/hex.hpp"

namespace cgcontact {

/// One side of a pair: nodes of the body's cells, and its axes (columns: grid axes in global ones).
template <class Memory>
struct RowSide {
  Kokkos::View<const std::array<int, 8>*, Memory> cell_nodes;
  Mat3 axes = Mat3::Identity();
};

/// Rows of groups, compressed: (groups + 1), (entries), (entries); unknowns ascend in each row.
template <class Memory>
struct CompressedGapRows {
  Kokkos::View<int*, Memory> begin, dof;
  Kokkos::View<double*, Memory> value;
};

/// Nodes of a group that come one after the other in any order, and are kept in ascending order with what they
/// contribute.
template <class Memory>
struct NodeShares {
  Kokkos::View<int*, Memory> node;
  Kokkos::View<double* [3], Kokkos::LayoutRight, Memory> share;
  Kokkos::View<char*, Memory> axes;  ///< bit i: the row has an entry for component i

  explicit NodeShares(std::size_t size)
      : node("cgcontact::contact::row_node", size),
        share("cgcontact::contact::row_share", size),
        axes("cgcontact::contact::row_axes", size) {}

  /// Adds N times a direction (grid axes) at a node to those in [begin, end); returns the new end.
  KOKKOS_INLINE_FUNCTION int add(int begin, int end, int n, double N, const Vec3& direction) const {
    int low = begin, high = end;
    while (low < high) {
      const int middle = (low + high) / 2;
      if (node(middle) < n)
        low = middle + 1;
      else
        high = middle;
    }
    if (low == end || node(low) != n) {
      for (int k = end; k > low; --k) {
        node(k) = node(k - 1);
        axes(k) = axes(k - 1);
        for (int i = 0; i < 3; ++i) share(k, i) = share(k - 1, i);
      }
      ++end;
      node(low) = n;
      axes(low) = 0;
      for (int i = 0; i < 3; ++i) share(low, i) = 0;
    }
    for (int i = 0; i < 3; ++i) {
      share(low, i) += N * direction[i];
      if (direction[i] != 0) axes(low) = static_cast<char>(axes(low) | 1 << i);
    }
    return end;
  }
};

/// Scans in place: numbers(g) becomes the sum before group g. Returns the total.
template <class Exec, class Memory>
int scan_in_place(const Exec& exec, const Kokkos::View<int*, Memory>& numbers) {
  const int size = static_cast<int>(numbers.extent(0));  // one more than there are groups; the last is 0
  int sum = 0;
  Kokkos::parallel_scan(
      "cgcontact::contact::row_begin", Kokkos::RangePolicy<Exec>(exec, 0, size),
      KOKKOS_LAMBDA(const int g, int& before, const bool last) {
        const int own = numbers(g);
        if (last) numbers(g) = before;
        before += own;
      },
      sum);
  exec.fence();
  return sum;
}

/// Makes the rows of the groups of one pair. first_point: (groups + 1), in `points`; area: of each group, m^2.
template <class Exec, class Memory>
CompressedGapRows<Memory> gap_rows(const Exec& exec, const ContactPointArrays<Memory>& points,
                                   const Kokkos::View<int*, Memory>& first_point,
                                   const Kokkos::View<double*, Memory>& area, const RowSide<Memory>& primary,
                                   const RowSide<Memory>& secondary) {
  static_assert(reaches<Exec, Memory>);
  using Numbers = Kokkos::View<int*, Memory>;
  constexpr int nodes_of_point = 16;
  const int num_groups = static_cast<int>(area.extent(0));
  const Kokkos::RangePolicy<Exec> groups(exec, 0, num_groups);
  const Numbers first("cgcontact::contact::row_first", num_groups + 1), end("cgcontact::contact::row_end", num_groups);
  Kokkos::parallel_for(
      "cgcontact::contact::row_count", groups,
      KOKKOS_LAMBDA(const int g) { first(g) = nodes_of_point * (first_point(g + 1) - first_point(g)); });
  const NodeShares<Memory> shares(scan_in_place(exec, first));
  CompressedGapRows<Memory> rows;
  rows.begin = Numbers("cgcontact::contact::row_begin", num_groups + 1);
  const Numbers begin = rows.begin;
  Kokkos::parallel_for(
      "cgcontact::contact::row_fill", groups, KOKKOS_LAMBDA(const int g) {
        int last = first(g);
        for (int q = first_point(g); q < first_point(g + 1); ++q) {
          const double fraction = points.weight(q) / area(g);
          const Vec3 along = fraction * Vec3(points.direction(q, 0), points.direction(q, 1), points.direction(q, 2));
          for (const bool second : {false, true}) {
            const RowSide<Memory>& side = second ? secondary : primary;
            const Vec3 local = side.axes.transpose() * (second ? along : Vec3(-along));
            const auto& nodes = side.cell_nodes(second ? points.secondary_cell(q) : points.primary_cell(q));
            double N[8];
            hex_shape(second ? &points.secondary_xi(q, 0) : &points.primary_xi(q, 0), N);
            for (int a = 0; a < 8; ++a) last = shares.add(first(g), last, nodes[a], N[a], local);
          }
        }
        end(g) = last;
        int entries = 0;
        for (int k = first(g); k < last; ++k)
          for (int i = 0; i < 3; ++i) entries += shares.axes(k) >> i & 1;
        begin(g) = entries;
      });
  const int num_entries = scan_in_place(exec, begin);
  rows.dof = Numbers("cgcontact::contact::row_dof", num_entries);
  rows.value = Kokkos::View<double*, Memory>("cgcontact::contact::row_value", num_entries);
  const Numbers dof = rows.dof;
  const Kokkos::View<double*, Memory> value = rows.value;
  Kokkos::parallel_for(
      "cgcontact::contact::row_compress", groups, KOKKOS_LAMBDA(const int g) {
        int e = begin(g);
        for (int k = first(g); k < end(g); ++k)
          for (int i = 0; i < 3; ++i) {
            if (!(shares.axes(k) >> i & 1)) continue;
            dof(e) = dof_of(shares.node(k), i);
            value(e++) = shares.share(k, i);
          }
      });
  exec.fence();
  return rows;
}

}  // namespace cgcontact
