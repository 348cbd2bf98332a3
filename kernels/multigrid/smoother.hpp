/// Chebyshev smoothing of one multigrid level. Its base is M = D + B^T k B: D the 3 x 3 node blocks of stiffness, ghost
/// penalty and supports, in thin bodies the blocks of whole columns of nodes (node_columns.hpp); B the rows of contact
/// groups with their stiffness k (and mean rows of the supports of small bodies, make_support_rows), which couple the
/// surface's unknowns for any kappa. M^-1 = D^-1 - W C^-1 W^T (Woodbury) with W = D^-1 B^T k^1/2 and the sparse,
/// surface-sized C = 1 + k^1/2 B D^-1 B^T k^1/2 (surface_matrix.hpp).
#pragma once

#include <memory>

#include "kernels/multigrid/surface_matrix.hpp"
#include "kernels/operator/node_columns.hpp"
#include "kernels/operator/system.hpp"

namespace cgcontact {

/// Mean row and summed stiffness of the supports of every cell (one per direction) of small bodies, whose supports are
/// stiffer, away from columns.
struct SupportRows {
  std::vector<GroupRow> rows;
  std::vector<double> stiffness;
  /// Contributions to the node blocks (node, block), where masters get a constrained node's own block alone
  /// (FastOperator::diagonal_blocks), less than the rows on the masters themselves.
  std::vector<std::pair<int, Mat3>> blocks;
};
template <class Real>
SupportRows make_support_rows(const ElasticSystem& system, const NodeColumns<Real>& columns);

struct SurfaceRows;

/// Node blocks and surface rows: applies M^-1.
template <class Real>
class SurfaceSmoother {
 public:
  using Vector = Kokkos::View<Real*, MemSpace>;
  using BlocksView = Kokkos::View<Real* [6], Kokkos::LayoutRight, MemSpace>;  ///< xx, yy, zz, xy, yz, zx

  /// blocks: node blocks of the operator without contact groups; what the support rows have in them is taken out.
  /// columns: with the blocks between their nodes. The matrices of the columns become their inverses. supports:
  /// make_support_rows. On several ranks: rows have entries at own nodes only, and what follows is collective.
  SurfaceSmoother(const ElasticSystem& system, const BlocksView& blocks, const NodeColumns<Real>& columns,
                  SupportRows supports);

  /// Sets rows and stiffness of the contact groups; factorises C.
  void set_groups(const std::vector<GroupRow>& rows, const std::vector<double>& stiffness);

  /// Takes a step: d = beta d + alpha M^-1 r; x += d. With beta = 0, d need not be initialised; with overwrite, x = d.
  void step(const ExecSpace& exec, const Vector& r, Real alpha, Real beta, const Vector& d, const Vector& x,
            bool overwrite) const;

 private:
  void store_rows(const SurfaceRows& rows);
  void make_matrix(const SurfaceRows& rows);
  void multiply_rows(const ExecSpace& exec, const Vector& r) const;
  Mat3 inverse(int node) const;
  void take_out_supports(const BlocksView& blocks);
  void invert_columns(const BlocksView& blocks);

  int num_nodes_ = 0;
  DofMap dofs_;
  NodeColumns<Real> columns_;  // inverse matrices
  SupportRows supports_;
  IntView block_of_node_;                                      // -1: a multiple of the identity, -2: in a column
  BlocksView inverse_;                                         // of the other nodes
  Kokkos::View<int* [3], Kokkos::LayoutRight, MemSpace> run_;  // first node, nodes, first block, -1 or -2
  Vector run_inverse_;                                         // where there is no block
  IntView touched_;                                            // nodes of surface rows
  IntView node_begin_, node_row_;                              // touched node -> (row, W)
  IntView row_begin_, row_node_;                               // row -> (node, W)
  Kokkos::View<Real*[3], Kokkos::LayoutRight, MemSpace> node_w_, row_w_;
  int num_rows_ = 0;
  Vector surface_;                                     // of the rows
  std::shared_ptr<const SurfaceMatrix<Real>> matrix_;  // C
};

}  // namespace cgcontact
