#include "tests/support/fit_patches.hpp"

namespace cgcontact::test {
namespace {

Eigen::Vector3i exponents(int t) {
  if (t == 0) return {0, 0, 0};
  if (t < 4) return Eigen::Vector3i::Unit(t - 1);
  const int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {2, 0}};
  return Eigen::Vector3i::Unit(pairs[t - 4][0]) + Eigen::Vector3i::Unit(pairs[t - 4][1]);
}

/// Factor of the derivative of term t along i; `to`: which term it is (-1: zero).
double derivative(int t, int i, int& to) {
  Eigen::Vector3i e = exponents(t);
  const double factor = e[i];
  to = -1;
  if (factor == 0) return 0;
  e[i] -= 1;
  for (int k = 0; k < 10; ++k)
    if (exponents(k) == e) to = k;
  return factor;
}

}  // namespace

double DenseFit::term(int t, const Eigen::Vector3d& x) {
  const Eigen::Vector3i e = exponents(t);
  return std::pow(x[0], e[0]) * std::pow(x[1], e[1]) * std::pow(x[2], e[2]);
}

Eigen::MatrixXd DenseFit::interior_rows(int degree, double nu) {
  const int T = degree == 1 ? 4 : 10, terms_of_divergence = degree == 1 ? 1 : 4;
  const int component[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(degree == 1 ? 3 : 18, 6 * T);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int t = 0; t < T; ++t) {
        int to;
        const double factor = derivative(t, j, to);
        if (to >= 0 && to < terms_of_divergence) rows(3 * to + i, component[i][j] * T + t) += factor;
      }
  if (degree == 1) return rows;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j)
      for (int t = 0; t < T; ++t)
        for (int k = 0; k < 3; ++k) {
          int once, twice = -1;
          double factor = derivative(t, k, once);
          if (once >= 0) factor *= derivative(once, k, twice);
          if (twice == 0) rows(12 + component[i][j], component[i][j] * T + t) += factor;
          factor = derivative(t, i, once);
          if (once >= 0) factor *= derivative(once, j, twice);
          if (once >= 0 && twice == 0) rows(12 + component[i][j], k * T + t) += factor / (1 + nu);
        }
  return rows;
}

DenseFit::Whitened DenseFit::whitened() const {
  Whitened w{C, {}, Eigen::LLT<Eigen::MatrixXd>(M)};
  w.C = w.factor.matrixL().solve(C.transpose()).transpose();
  w.norm = w.C.rowwise().norm();
  for (Eigen::Index r = 0; r < C.rows(); ++r)
    if (w.norm[r] > 0)
      w.C.row(r) /= w.norm[r];
    else
      w.norm[r] = 1;
  return w;
}

Eigen::VectorXd DenseFit::solve_kkt() const {
  const Eigen::Index n = C.cols(), rows = C.rows();
  Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + rows, n + rows);
  kkt.topLeftCorner(n, n) = M;
  kkt.topRightCorner(n, rows) = C.transpose();
  kkt.bottomLeftCorner(rows, n) = C;
  Eigen::VectorXd rhs(n + rows);
  rhs << M * a, values;
  return kkt.completeOrthogonalDecomposition().solve(rhs).head(n);
}

Eigen::VectorXd DenseFit::solve_truncated(double tolerance, int& dropped) const {
  const Whitened w = whitened();
  const Eigen::VectorXd defect = (values - C * a).cwiseQuotient(w.norm);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(w.C * w.C.transpose());
  const double threshold = tolerance * tolerance * eigen.eigenvalues().maxCoeff();
  Eigen::VectorXd x = eigen.eigenvectors().transpose() * defect;
  dropped = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (eigen.eigenvalues()[i] > threshold) {
      x[i] /= eigen.eigenvalues()[i];
    } else {
      x[i] = 0;
      ++dropped;
    }
  }
  return a + w.factor.matrixU().solve(w.C.transpose() * (eigen.eigenvectors() * x));
}

double DenseFit::level(const Eigen::VectorXd& x) const { return std::sqrt(x.dot(M * x)); }

double DenseFit::residual(const Eigen::VectorXd& x) const {
  return (values - C * x).cwiseQuotient(whitened().norm).lpNorm<Eigen::Infinity>() / level(x);
}

}  // namespace cgcontact::test
