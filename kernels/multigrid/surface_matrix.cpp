#include "kernels/multigrid/surface_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "core/base/process/ranks.hpp"

namespace cgcontact {
namespace {

void throw_if(bool failed) {
  if (failed) throw std::runtime_error("smoother: the surface matrix is not definite");
}

}  // namespace

template <class Real>
SurfaceMatrix<Real>::SurfaceMatrix(int num_rows, const Entries& entries) : alone_(num_rows) {
  std::iota(alone_.begin(), alone_.end(), 0);
  throw_if(!factorise(num_rows, entries, alone_factor_));
}

template <class Real>
SurfaceMatrix<Real>::SurfaceMatrix(int num_rows, const Entries& entries, const Halo::Comm& comm) {
  std::vector<int> own;
  for (const auto& entry : entries)
    if (entry.row() == entry.col()) own.push_back(entry.row());
  std::sort(own.begin(), own.end());
  own.erase(std::unique(own.begin(), own.end()), own.end());
  const std::vector<RowPart> parts = parts_of_shared_rows(own);
  for (const RowPart& part : parts)
    if (part.rank == this_rank()) shared_.push_back(part.row);
  std::set_difference(own.begin(), own.end(), shared_.begin(), shared_.end(), std::back_inserter(alone_));
  std::vector<int> position(num_rows, -1);  // among the rows alone; of shared ones -2 and less
  for (std::size_t k = 0; k < alone_.size(); ++k) position[alone_[k]] = static_cast<int>(k);
  for (std::size_t k = 0; k < shared_.size(); ++k) position[shared_[k]] = -2 - static_cast<int>(k);
  throw_if(largest_over_ranks(!factorise_alone(entries, position)) > 0);  // on all ranks
  if (!parts.empty()) invert_shared(num_rows, entries, parts, comm);
}

template <class Real>
bool SurfaceMatrix<Real>::factorise(int num_rows, const Entries& entries, Factor& factor) {
  Sparse matrix(num_rows, num_rows);
  matrix.setFromTriplets(entries.begin(), entries.end());
  factor.compute(matrix);
  return factor.info() == Eigen::Success;
}

template <class Real>
bool SurfaceMatrix<Real>::factorise_alone(const Entries& entries, const std::vector<int>& position) {
  Entries alone, coupling;
  for (const auto& entry : entries) {
    const int row = position[entry.row()], col = position[entry.col()];
    if (row >= 0 && col >= 0) alone.emplace_back(row, col, entry.value());
    if (row < 0 && col >= 0) coupling.emplace_back(-2 - row, col, entry.value());
    if (row >= 0 && col < 0) coupling.emplace_back(-2 - col, row, entry.value());
  }
  const int num_alone = static_cast<int>(alone_.size());
  for (int k = 0; k < num_alone; ++k) alone.emplace_back(k, k, Real(1));
  coupling_ = Sparse(static_cast<int>(shared_.size()), num_alone);
  coupling_.setFromTriplets(coupling.begin(), coupling.end());
  return alone_.empty() || factorise(num_alone, alone, alone_factor_);
}

template <class Real>
void SurfaceMatrix<Real>::invert_shared(int num_rows, const Entries& entries, const std::vector<RowPart>& parts,
                                        const Halo::Comm& comm) {
  Entries all = gather(entries);
  for (int r = 0; r < num_rows; ++r) all.emplace_back(r, r, Real(1));
  Factor factor;
  throw_if(!factorise(num_rows, all, factor));
  std::vector<int> rows;  // that any ranks share
  for (const RowPart& part : parts)
    if (rows.empty() || rows.back() != part.row) rows.push_back(part.row);
  Dense columns(rows.size(), shared_.size());
  std::vector<char> is_near(rows.size(), 0);
  for (std::size_t k = 0; k < shared_.size(); ++k) {
    const Vector unit = Vector::Unit(num_rows, shared_[k]), column = factor.solve(unit);
    columns.col(k) = column(rows);
    const Real rounding = std::numeric_limits<Real>::epsilon() * column[shared_[k]];
    for (std::size_t r = 0; r < rows.size(); ++r) is_near[r] |= !(std::abs(column[rows[r]]) <= rounding);
  }
  std::vector<int> chosen;
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (is_near[r]) {
      chosen.push_back(static_cast<int>(r));
      near_.push_back(rows[r]);
    }
  inverse_.resize(static_cast<Eigen::Index>(shared_.size()), static_cast<Eigen::Index>(chosen.size()));
  for (std::size_t n = 0; n < chosen.size(); ++n) inverse_.col(n) = columns.row(chosen[n]).transpose();
  sums_ = std::make_unique<const RowSums>(comm, parts, near_);
}

template <class Real>
typename SurfaceMatrix<Real>::Vector SurfaceMatrix<Real>::solve_alone(const Vector& g) const {
  if (alone_.empty()) return g;
  return alone_factor_.solve(g);
}

template <class Real>
void SurfaceMatrix<Real>::solve(const ExecSpace& exec, const Kokkos::View<Real*, MemSpace>& g) const {
  Eigen::Map<Vector> values(g.data(), static_cast<Eigen::Index>(g.extent(0)));
  Vector of_alone = solve_alone(values(alone_));
  if (sums_) {
    const Vector passed_on = coupling_ * of_alone;
    values(shared_) -= passed_on;
    sums_->sum(exec, g.data());
    exec.fence();
    const Vector of_shared = inverse_ * values(near_);
    of_alone -= solve_alone(coupling_.transpose() * of_shared);
    values(shared_) = of_shared;
  }
  values(alone_) = of_alone;
}

template class SurfaceMatrix<float>;
template class SurfaceMatrix<double>;

}  // namespace cgcontact
