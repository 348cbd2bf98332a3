#include "recovery/constrained_fit.hpp"

namespace cgcontact {
namespace {

/// Number of 4-term blocks: six components per body.
constexpr int num_components = 6;

}  // namespace

ConstrainedFitStatus constrain_fit(const std::vector<MassMatrix>& mass, const Eigen::MatrixXd& C,
                                   const Eigen::VectorXd& lambda, double rank_tolerance, Eigen::VectorXd& a) {
  ConstrainedFitStatus status;
  status.rows = static_cast<int>(C.rows());
  if (status.rows == 0) return status;
  // Whitening y = L^T a: the patch norm becomes the Euclidean one; rows become C L^-T and are normalised.
  std::vector<Eigen::LLT<MassMatrix>> factor;
  for (const MassMatrix& m : mass) factor.emplace_back(m);
  Eigen::MatrixXd Cw(C.rows(), C.cols());
  for (std::size_t b = 0; b < mass.size(); ++b)
    for (int k = 0; k < num_components; ++k) {
      const int column = static_cast<int>(b * num_components + k) * num_terms;
      Cw.middleCols<num_terms>(column) =
          factor[b].matrixL().solve(C.middleCols<num_terms>(column).transpose()).transpose();
    }
  Eigen::VectorXd defect = lambda - C * a;
  const Eigen::VectorXd norm = Cw.rowwise().norm();
  for (Eigen::Index r = 0; r < Cw.rows(); ++r)
    if (norm[r] > 0) {
      Cw.row(r) /= norm[r];
      defect[r] /= norm[r];
    }
  // Pseudo-inverse from the eigenvalues of C C^T (squares of the singular values); those kept are above
  // rank_tolerance^2, so squaring costs no accuracy that matters.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Cw * Cw.transpose());
  const Eigen::VectorXd& values = eigen.eigenvalues();
  const double threshold = rank_tolerance * rank_tolerance * values.maxCoeff();
  Eigen::VectorXd multiplier = eigen.eigenvectors().transpose() * defect;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (values[i] > threshold) {
      multiplier[i] /= values[i];
    } else {
      multiplier[i] = 0;
      ++status.truncated;
    }
  }
  const Eigen::VectorXd y = Cw.transpose() * (eigen.eigenvectors() * multiplier);
  double level = 0;
  for (std::size_t b = 0; b < mass.size(); ++b)
    for (int k = 0; k < num_components; ++k) {
      const int column = static_cast<int>(b * num_components + k) * num_terms;
      Eigen::Vector4d dy = y.segment<num_terms>(column);
      a.segment<num_terms>(column) += factor[b].matrixU().solve(dy);
      level += (factor[b].matrixU() * Eigen::Vector4d(a.segment<num_terms>(column))).squaredNorm();
    }
  const Eigen::VectorXd remaining = defect - Cw * y;
  status.inconsistent = remaining.lpNorm<Eigen::Infinity>() > 0.01 * std::sqrt(level);
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

}  // namespace cgcontact
