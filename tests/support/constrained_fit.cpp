#include "tests/support/constrained_fit.hpp"

namespace cgcontact::test {
namespace {

/// Solves G x = b if it is certain that no eigenvalue is below the tolerance (squared) times the largest one: the
/// Frobenius norms of G and its inverse bound both. Most patches on one smooth face pass; it saves the eigenvalues.
bool solve_full_rank(const Eigen::MatrixXd& G, double rank_tolerance, const Eigen::VectorXd& b, Eigen::VectorXd& x) {
  const Eigen::LLT<Eigen::MatrixXd> cholesky(G);
  if (cholesky.info() != Eigen::Success) return false;
  const double inverse = cholesky.solve(Eigen::MatrixXd::Identity(G.rows(), G.cols())).norm();
  if (!(inverse * G.norm() * rank_tolerance * rank_tolerance < 0.999)) return false;
  x = cholesky.solve(b);
  return true;
}

/// The pseudo-inverse from the eigenvalues of G = C C^T (squares of the singular values); those kept are above the
/// tolerance (squared) times the largest one, so squaring costs no accuracy that matters. Returns how many are dropped.
int solve_truncated(const Eigen::MatrixXd& G, double rank_tolerance, const Eigen::VectorXd& b, Eigen::VectorXd& x) {
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

}  // namespace

Eigen::Matrix<double, 1, 6 * num_terms> traction_row(const Vec3& d, const Vec3& n, const Vec3& e) {
  const double p[num_terms] = {1, d[0], d[1], d[2]};
  Eigen::Matrix<double, 1, 6 * num_terms> row = decltype(row)::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int t = 0; t < num_terms; ++t) row[component_of[i][j] * num_terms + t] += e[i] * n[j] * p[t];
  return row;
}

Eigen::Matrix<double, 3, 6 * num_terms> divergence_rows() {
  Eigen::Matrix<double, 3, 6 * num_terms> rows = decltype(rows)::Zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) rows(i, component_of[i][j] * num_terms + 1 + j) = 1;
  return rows;
}

ConstrainedFitStatus constrain_fit(const std::vector<MassMatrix>& mass, const Eigen::MatrixXd& C,
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

void constrain_fit_kkt(const std::vector<MassMatrix>& mass, const Eigen::MatrixXd& C, const Eigen::VectorXd& lambda,
                       Eigen::VectorXd& a) {
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
