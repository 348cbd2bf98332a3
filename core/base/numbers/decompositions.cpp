#include "core/base/numbers/decompositions.hpp"

namespace cgcontact {

template <int N>
SymmetricEigen<N>::SymmetricEigen(const Matrix& matrix) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(matrix);
  values_ = solver.eigenvalues();
  vectors_ = solver.eigenvectors();
}

template class SymmetricEigen<2>;
template class SymmetricEigen<3>;
template class SymmetricEigen<6>;
template class SymmetricEigen<Eigen::Dynamic>;

Vec3 eigenvalues(const Mat3& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

SingularValues::SingularValues(const Eigen::MatrixXd& matrix, unsigned vectors) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, vectors);
  values_ = svd.singularValues();
  if (svd.computeU()) left_ = svd.matrixU();
  if (svd.computeV()) right_ = svd.matrixV();
}

Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double tolerance) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(tolerance);
  decomposition.compute(A);
  return decomposition.solve(b);
}

// Rodrigues' formula, from a half turn on where the angle is obtuse: between axes of coordinates all terms are exact.
Mat3 rotation_between(const Vec3& from, const Vec3& to) {
  const double cosine = from.dot(to);
  if (cosine < 0) {
    const Vec3 normal = from.unitOrthogonal();
    return rotation_between(-from, to) * (2 * normal * normal.transpose() - Mat3::Identity());
  }
  const Vec3 axis = from.cross(to);
  Mat3 cross;
  cross << 0, -axis[2], axis[1], axis[2], 0, -axis[0], -axis[1], axis[0], 0;
  return cosine * Mat3::Identity() + cross + axis * axis.transpose() / (1 + cosine);
}

}  // namespace cgcontact
