/// Surface matrix C of a smoother, factorised. Ranks have their shares of its entries. Rows that one rank alone has
/// couple with others through its own rows: it eliminates them. What the other rows, which several ranks have, then get
/// is read off the inverse of the whole matrix, whose entries fall off with the distance of two rows, as C >= 1: those
/// that are zero to rounding need no message, so that a rank hears from near ranks alone.
#pragma once

#include <Eigen/Sparse>
#include <memory>
#include <vector>

#include "kernels/mesh/halo.hpp"
#include "kernels/mesh/row_sums.hpp"

namespace cgcontact {

template <class Real>
class SurfaceMatrix {
 public:
  using Entries = std::vector<Eigen::Triplet<Real>>;  ///< of the lower triangle

  /// Factorises the matrix of one rank, which has all entries. Both throw std::runtime_error if it is not definite.
  SurfaceMatrix(int num_rows, const Entries& entries);
  /// Factorises 1 + the sum of the entries of all ranks; each has those of rows that couple at its own nodes, with
  /// their diagonals. Collective.
  SurfaceMatrix(int num_rows, const Entries& entries, const Halo::Comm& comm);

  /// Computes g = C^-1 g. On several ranks g is a sum over them, and each gets the rows of its own entries. Collective.
  void solve(const ExecSpace& exec, const Kokkos::View<Real*, MemSpace>& g) const;

 private:
  using Sparse = Eigen::SparseMatrix<Real>;
  using Factor = Eigen::SimplicialLLT<Sparse>;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  using Dense = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

  static bool factorise(int num_rows, const Entries& entries, Factor& factor);
  bool factorise_alone(const Entries& entries, const std::vector<int>& position);
  void invert_shared(int num_rows, const Entries& entries, const std::vector<RowPart>& parts, const Halo::Comm& comm);
  Vector solve_alone(const Vector& g) const;

  std::vector<int> alone_, shared_;  ///< rows that this rank has alone; that it shares
  Factor alone_factor_;
  Sparse coupling_;                      ///< (shared row, row alone)
  std::vector<int> near_;                ///< rows that ranks share and that those shared here depend on
  Dense inverse_;                        ///< (shared row, near row) of C^-1
  std::unique_ptr<const RowSums> sums_;  ///< of near rows; nullptr: no ranks share rows
};

}  // namespace cgcontact
