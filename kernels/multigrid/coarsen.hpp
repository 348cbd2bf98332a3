/// One step from a grid to the grid of twice the cell size: cells, supports, contact rows, and the transfer of vectors.
/// The coarse stiffness is the Galerkin product P^T K P exactly (moments add up); the ghost penalty is discretised
/// anew; support and contact terms keep their points and their groups per coarse cell, with the stiffness kappa E/h of
/// the coarse h (measured in 2D: inheriting kappa E/h_fine lets the iterations grow with the number of levels).
#pragma once

#include "kernels/operator/system.hpp"

namespace cgcontact {

/// Cells of twice the size with the sum of their children's moments. No boundary points, no solid.
CutCells coarse_cut_cells(const CutCells& fine);

/// Two cells or less in every direction: such a body is carried over to the next level as it is.
bool is_coarsest(const CutCells& cells);

/// The next level of a body: coarse_cut_cells, or the same cells again (no boundary points, no solid).
CutCells next_cut_cells(const CutCells& fine);

/// Whether a level has larger cells of a body than the one before.
bool is_coarsened(const CutCells& fine, const CutCells& coarse);

/// Support points of one body in their coarse cells, with half the stiffness; at most 27 per cell and direction.
/// Unchanged where the body is carried over.
std::vector<SupportTerm> coarse_supports(const CutCells& fine, const CutCells& coarse,
                                         const std::vector<SupportTerm>& terms);

/// Trilinear prolongation P: x_fine(n) = 1/8 sum_a x_coarse(parents(n, a)), parents repeated where n lies on a coarse
/// plane; children: the fine nodes around a coarse node, offset (a, b, c) - 1 at (a * 3 + b) * 3 + c, or -1.
/// The identity on bodies that are carried over.
struct Transfer {
  Kokkos::View<int* [8], Kokkos::LayoutRight, MemSpace> parents;
  Kokkos::View<int* [27], Kokkos::LayoutRight, MemSpace> children;
};

Transfer make_transfer(const ElasticSystem& fine, const ElasticSystem& coarse);

/// Rows restricted by P^T and merged per coarse cell of the primary body: mean of the rows weighted with `stiffness`
/// (with `full_stiffness` where all members are open). members: coarse row of each fine row. Stiffnesses are summed,
/// and halved where that body has been coarsened.
struct CoarseRows {
  std::vector<GroupRow> rows;
  std::vector<double> stiffness, full_stiffness;
};
CoarseRows coarse_rows(const ElasticSystem& fine, const ElasticSystem& coarse, const Transfer& transfer,
                       const std::vector<GroupRow>& rows, const std::vector<double>& stiffness,
                       const std::vector<double>& full_stiffness);

/// x_fine += P x_coarse.
template <class Exec, class X, class Y>
void prolongate_add(const Exec& exec, const Transfer& transfer, const X& coarse, const Y& fine) {
  using Real = typename Y::non_const_value_type;
  const auto parents = transfer.parents;
  Kokkos::parallel_for(
      "cgcontact::coarsen::prolongate", Kokkos::RangePolicy<Exec>(exec, 0, parents.extent(0)),
      KOKKOS_LAMBDA(const int n) {
        Real sum[3] = {0, 0, 0};
        for (int a = 0; a < 8; ++a) {
          const int p = parents(n, a);
          for (int i = 0; i < 3; ++i) sum[i] += coarse(dof_of(p, i));
        }
        for (int i = 0; i < 3; ++i) fine(dof_of(n, i)) += Real(0.125) * sum[i];
      });
}

/// x_coarse = P^T x_fine.
template <class Exec, class X, class Y>
void restrict_to(const Exec& exec, const Transfer& transfer, const X& fine, const Y& coarse) {
  using Real = typename Y::non_const_value_type;
  const auto children = transfer.children;
  Kokkos::parallel_for(
      "cgcontact::coarsen::restrict", Kokkos::RangePolicy<Exec>(exec, 0, children.extent(0)),
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
