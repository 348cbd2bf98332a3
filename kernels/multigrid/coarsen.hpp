/// One step to the grid of twice the cell size: cells, supports, contact rows, and the transfer of vectors. The coarse
/// stiffness is the Galerkin product P^T K P exactly (moments add up); the ghost penalty is discretised anew; support
/// and contact terms keep their points and their groups per coarse cell, with the stiffness kappa E/h of the coarse h
/// (measured in 2D: with kappa E/h_fine the iterations grow with the number of levels).
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "kernels/mesh/launch.hpp"
#include "kernels/operator/system.hpp"

namespace cgcontact {

/// Returns cells of twice the size with the sum of their children's moments; of a body of several levels,
/// CellTree::coarsened: cells that are not merged stay as they are. No boundary points, no solid.
CutCells coarse_cut_cells(const CutCells& fine);

/// Returns whether the cells have one level, two cells or less in every direction: such a body is carried over to the
/// next level.
bool is_coarsest(const CutCells& cells);

/// Returns the next level of a body: coarse_cut_cells, or the same cells again (no boundary points, no solid).
CutCells next_cut_cells(const CutCells& fine);

/// Map from the cells of a system's levels to those of the next coarser one.
class CoarseCells {
 public:
  CoarseCells(const ElasticSystem& fine, const ElasticSystem& coarse);

  struct CoarseCell {
    int level, cell;
    bool larger;  ///< its parent, otherwise the cell as it is
  };
  CoarseCell of(int level, int cell) const;

 private:
  std::vector<const BodyMesh*> fine_, coarse_;
  std::vector<int> own_;     ///< of each fine level: the coarse level with cells as large, -1: none
  std::vector<int> larger_;  ///< that with cells of twice the size, -1: none
};

/// Returns support points in their coarse cells, of all levels, with half the stiffness in a larger cell; at most 27
/// per cell and direction. Unchanged where the body is carried over.
std::vector<std::vector<SupportTerm>> coarse_supports(const ElasticSystem& fine, const ElasticSystem& coarse,
                                                      bool firm_holds);

/// Trilinear prolongation P: x_fine(n) = 1/8 sum_a x_coarse(parents(n, a)), parents repeated where n lies on a coarse
/// plane; children: the fine nodes around a coarse node, offset (a, b, c) - 1 at (a * 3 + b) * 3 + c, or -1. Fine nodes
/// of other ranks have parents -1. The identity on bodies that are carried over. Where nodes are constrained, P and its
/// transpose are rows instead, empty at constrained nodes.
struct Transfer {
  Kokkos::View<int* [8], Kokkos::LayoutRight, MemSpace> parents;
  Kokkos::View<int* [27], Kokkos::LayoutRight, MemSpace> children;
  struct Rows {
    IntView begin, node;  ///< (nodes + 1), (entries)
    RealView weight;
  };
  bool by_rows = false;
  Rows parent_rows, child_rows;
};

Transfer make_transfer(const ElasticSystem& fine, const ElasticSystem& coarse);

/// Coarsening of contact rows: restricted by P^T and merged per coarse cell of the coarser body. Keeps the rows of P at
/// their nodes instead of the grids.
class RowCoarsening {
 public:
  RowCoarsening() = default;
  /// Finds the coarse rows. rows: their positions; their entries only matter on the finest grid (`before`: nullptr),
  /// where they say which nodes contact rows have.
  RowCoarsening(const ElasticSystem& fine, const ElasticSystem& coarse, const Transfer& transfer,
                const std::vector<GroupRow>& rows, const RowCoarsening* before);

  /// Returns the coarse rows without entries.
  const std::vector<GroupRow>& coarse_rows() const { return coarse_rows_; }

  /// State of a grid's rows: stiffness, that when closed; whether the entries have changed since the last update.
  struct Present {
    std::vector<double> stiffness, full_stiffness;
    std::vector<char> changed;
    bool any_changed() const { return std::find(changed.begin(), changed.end(), 1) != changed.end(); }
  };
  /// Sets the entries of those coarse rows that are no longer the same: the mean of the rows weighted with `stiffness`
  /// (with `full_stiffness` where all members are open). Stiffnesses are summed, and halved where the coarser body has
  /// been coarsened.
  Present update(const std::vector<GroupRow>& fine, const Present& present, const ElasticSystem& coarse,
                 std::vector<GroupRow>& rows);

 private:
  void find_members(const ElasticSystem& fine, const ElasticSystem& coarse, const std::vector<GroupRow>& rows);
  std::vector<std::pair<int, double>> merged(const std::vector<int>& members, const std::vector<GroupRow>& fine,
                                             const std::vector<double>& share) const;

  std::vector<GroupRow> coarse_rows_;
  std::vector<std::vector<int>> members_;  ///< fine rows of each coarse one
  std::vector<double> factor_;             ///< of the stiffness of each fine row
  std::vector<double> share_;              ///< of each fine row in its coarse one, at the last update
  std::vector<int> row_of_node_, begin_{0};
  std::vector<std::pair<int, double>> parents_;
  std::vector<int> coarse_nodes_;  ///< that coarse rows may have entries at
};

/// y(n) (+)= sum of weight * x(node).
template <bool add, class Exec, class X, class Y>
void apply_transfer_rows(const Exec& exec, const Transfer::Rows& rows, const X& x, const Y& y) {
  using Real = typename Y::non_const_value_type;
  launch(
      "cgcontact::coarsen::rows", Kokkos::RangePolicy<Exec>(exec, 0, rows.begin.extent(0) - 1), grain_of_medium,
      KOKKOS_LAMBDA(const int n) {
        Real sum[3] = {0, 0, 0};
        for (int e = rows.begin(n); e < rows.begin(n + 1); ++e)
          for (int i = 0; i < 3; ++i) sum[i] += static_cast<Real>(rows.weight(e)) * x(dof_of(rows.node(e), i));
        for (int i = 0; i < 3; ++i) y(dof_of(n, i)) = add ? y(dof_of(n, i)) + sum[i] : sum[i];
      });
}

/// x_fine += P x_coarse, both consistent (DofMap).
template <class Exec, class X, class Y>
void prolongate_add(const Exec& exec, const Transfer& transfer, const DofMap& fine_dofs, const X& coarse,
                    const Y& fine) {
  using Real = typename Y::non_const_value_type;
  if (transfer.by_rows) {
    apply_transfer_rows<true>(exec, transfer.parent_rows, coarse, fine);
    apply_constraints(exec, fine_dofs, fine);
    return;
  }
  const auto parents = transfer.parents;
  launch(
      "cgcontact::coarsen::prolongate", Kokkos::RangePolicy<Exec>(exec, 0, parents.extent(0)), grain_of_medium,
      KOKKOS_LAMBDA(const int n) {
        Real sum[3] = {0, 0, 0};
        if (parents(n, 0) < 0) return;
        for (int a = 0; a < 8; ++a) {
          const int p = parents(n, a);
          for (int i = 0; i < 3; ++i) sum[i] += coarse(dof_of(p, i));
        }
        for (int i = 0; i < 3; ++i) fine(dof_of(n, i)) += Real(0.125) * sum[i];
      });
  if (fine_dofs.halo()) apply_constraints(exec, fine_dofs, fine);
}

/// x_coarse = P^T x_fine, both zero at constrained nodes.
template <class Exec, class X, class Y>
void restrict_to(const Exec& exec, const Transfer& transfer, const DofMap& coarse_dofs, const X& fine,
                 const Y& coarse) {
  using Real = typename Y::non_const_value_type;
  if (transfer.by_rows) {
    apply_transfer_rows<false>(exec, transfer.child_rows, fine, coarse);
    apply_constraints_transposed(exec, coarse_dofs, coarse);
    return;
  }
  const auto children = transfer.children;
  launch(
      "cgcontact::coarsen::restrict", Kokkos::RangePolicy<Exec>(exec, 0, children.extent(0)), grain_of_medium,
      KOKKOS_LAMBDA(const int n) {
        Real sum[3] = {0, 0, 0};
        const Real weight[3] = {Real(0.5), Real(1), Real(0.5)};
        for (int c = 0; c < 27; ++c) {
          const int child = children(n, c);
          if (child < 0) continue;
          const Real w = weight[c / 9] * weight[c / 3 % 3] * weight[c % 3];
          for (int i = 0; i < 3; ++i) sum[i] += w * fine(dof_of(child, i));
        }
        for (int i = 0; i < 3; ++i) coarse(dof_of(n, i)) = sum[i];
      });
}

}  // namespace cgcontact
