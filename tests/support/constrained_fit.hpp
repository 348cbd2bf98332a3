/// The constrained least-squares fit of one patch: min |M-weighted a - a0| subject to C a = Lambda (paper, equation 3
/// and, with the auxiliary patch, equation 13), by whitening and a truncated pseudo-inverse instead of the KKT matrix.
/// The plain twin of recovery/batched/batched_fit.hpp.
#pragma once

#include <vector>

#include "recovery/patch/patches.hpp"

namespace cgcontact::test {

struct ConstrainedFitStatus {
  int rows = 0;
  int truncated = 0;          ///< rows (singular values) dropped by the truncation: redundant or nearly so
  bool inconsistent = false;  ///< data that no polynomial meets: residual above 1 % of the patch's stress level
};

using MassMatrix = Eigen::Matrix<double, num_terms, num_terms>;

/// Number of 4-term blocks: six components per body.
constexpr int num_components = 6;

/// Component of (i, j) of a symmetric tensor: xx, yy, zz, xy, yz, zx.
constexpr int component_of[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/// Traction R(n) P(d): row of the component along e of sigma n, at offset d from the polynomial's centre, on the
/// coefficients of linear polynomials (component, term).
inline Eigen::Matrix<double, 1, 6 * num_terms> traction_row(const Vec3& d, const Vec3& n, const Vec3& e) {
  const double p[num_terms] = {1, d[0], d[1], d[2]};
  Eigen::Matrix<double, 1, 6 * num_terms> row = decltype(row)::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int t = 0; t < num_terms; ++t) row[component_of[i][j] * num_terms + t] += e[i] * n[j] * p[t];
  return row;
}

/// Divergence rows (equation 4): row i is (div sigma)_i per cell unit; constant for linear polynomials.
inline Eigen::Matrix<double, 3, 6 * num_terms> divergence_rows() {
  Eigen::Matrix<double, 3, 6 * num_terms> rows = decltype(rows)::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rows(i, component_of[i][j] * num_terms + 1 + j) = 1;
  return rows;
}

/// Solves G x = b if it is certain that no eigenvalue is below the tolerance (squared) times the largest one: the
/// Frobenius norms of G and its inverse bound both. Most patches on one smooth face pass; it saves the eigenvalues.
inline bool solve_full_rank(const Eigen::MatrixXd& G, double rank_tolerance, const Eigen::VectorXd& b,
                            Eigen::VectorXd& x) {
  const Eigen::LLT<Eigen::MatrixXd> cholesky(G);
  if (cholesky.info() != Eigen::Success) return false;
  const double inverse = cholesky.solve(Eigen::MatrixXd::Identity(G.rows(), G.cols())).norm();
  if (!(inverse * G.norm() * rank_tolerance * rank_tolerance < 0.999)) return false;
  x = cholesky.solve(b);
  return true;
}

/// The pseudo-inverse from the eigenvalues of G = C C^T (squares of the singular values); those kept are above the
/// tolerance (squared) times the largest one, so squaring costs no accuracy that matters. Returns how many are dropped.
inline int solve_truncated(const Eigen::MatrixXd& G, double rank_tolerance, const Eigen::VectorXd& b,
                           Eigen::VectorXd& x) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(G);
  const Eigen::VectorXd& values = eigen.eigenvalues();
  const double threshold = rank_tolerance * rank_tolerance * values.maxCoeff();
  Eigen::VectorXd projected = eigen.eigenvectors().transpose() * b;
  int truncated = 0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (values[i] > threshold) {
      projected[i] /= values[i];
    } else {
      projected[i] = 0;
      ++truncated;
    }
  }
  x = eigen.eigenvectors() * projected;
  return truncated;
}

/// `mass`: one 4 x 4 matrix per body involved (1 or 2); a: their coefficients (24 each), unconstrained on entry,
/// constrained on return. C: rows x (24 or 48).
inline ConstrainedFitStatus constrain_fit(const std::vector<MassMatrix>& mass, const Eigen::MatrixXd& C,
                                          const Eigen::VectorXd& lambda, double rank_tolerance, Eigen::VectorXd& a) {
  ConstrainedFitStatus status;
  status.rows = static_cast<int>(C.rows());
  if (status.rows == 0) return status;
  // Whitening y = L^T a: the patch norm becomes the Euclidean one; rows become C L^-T and are normalised.
  MassMatrix factor[2], inverse[2];
  Eigen::MatrixXd Cw(C.rows(), C.cols());
  for (std::size_t b = 0; b < mass.size(); ++b) {
    factor[b] = mass[b].llt().matrixL();
    inverse[b] = factor[b].triangularView<Eigen::Lower>().solve(MassMatrix::Identity());
    for (int k = 0; k < num_components; ++k) {
      const int column = static_cast<int>(b * num_components + k) * num_terms;
      Cw.middleCols<num_terms>(column).noalias() = C.middleCols<num_terms>(column) * inverse[b].transpose();
    }
  }
  Eigen::VectorXd defect = lambda - C * a, multiplier;
  const Eigen::VectorXd norm = Cw.rowwise().norm();
  for (Eigen::Index r = 0; r < Cw.rows(); ++r)
    if (norm[r] > 0) {
      Cw.row(r) /= norm[r];
      defect[r] /= norm[r];
    }
  Eigen::MatrixXd gram(Cw.rows(), Cw.rows());
  gram.noalias() = Cw * Cw.transpose();
  const bool full_rank = solve_full_rank(gram, rank_tolerance, defect, multiplier);
  if (!full_rank) status.truncated = solve_truncated(gram, rank_tolerance, defect, multiplier);
  const Eigen::VectorXd y = Cw.transpose() * multiplier;
  double level = 0;
  for (std::size_t b = 0; b < mass.size(); ++b)
    for (int k = 0; k < num_components; ++k) {
      const int column = static_cast<int>(b * num_components + k) * num_terms;
      a.segment<num_terms>(column) += inverse[b].transpose() * y.segment<num_terms>(column);
      level += (factor[b].transpose() * a.segment<num_terms>(column)).squaredNorm();
    }
  // Without truncation the rows are met to rounding.
  if (!full_rank) status.inconsistent = (defect - Cw * y).lpNorm<Eigen::Infinity>() > 0.01 * std::sqrt(level);
  return status;
}

/// Plain reference: dense KKT matrix, solved by a rank-revealing complete orthogonal decomposition (least norm).
inline void constrain_fit_kkt(const std::vector<MassMatrix>& mass, const Eigen::MatrixXd& C,
                              const Eigen::VectorXd& lambda, Eigen::VectorXd& a) {
  const Eigen::Index n = C.cols(), rows = C.rows();
  Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + rows, n + rows);
  for (std::size_t b = 0; b < mass.size(); ++b)
    for (int k = 0; k < num_components; ++k) {
      const Eigen::Index i = static_cast<Eigen::Index>(b * num_components + k) * num_terms;
      kkt.block<num_terms, num_terms>(i, i) = mass[b];
    }
  kkt.topRightCorner(n, rows) = C.transpose();
  kkt.bottomLeftCorner(rows, n) = C;
  Eigen::VectorXd rhs(n + rows);
  rhs.head(n) = kkt.topLeftCorner(n, n) * a;
  rhs.tail(rows) = lambda;
  a = kkt.completeOrthogonalDecomposition().solve(rhs).head(n);
}

}  // namespace cgcontact::test
