/// Decompositions of small matrices by Eigen, compiled once: a file that instantiates one of its own takes seconds
/// longer.
#pragma once

#include "core/base/numbers/types.hpp"

namespace cgcontact {

/// Eigenvalues, ascending, and orthonormal eigenvectors (columns) of a symmetric N x N matrix, of which the lower
/// triangle is read; N: 2, 3, 6 or Eigen::Dynamic.
template <int N>
class SymmetricEigen {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  SymmetricEigen() = default;
  explicit SymmetricEigen(const Matrix& matrix);

  const Vector& eigenvalues() const { return values_; }
  const Matrix& eigenvectors() const { return vectors_; }

 private:
  Vector values_;
  Matrix vectors_;
};
extern template class SymmetricEigen<2>;
extern template class SymmetricEigen<3>;
extern template class SymmetricEigen<6>;
extern template class SymmetricEigen<Eigen::Dynamic>;

/// Eigenvalues of a symmetric tensor, ascending.
Vec3 eigenvalues(const Mat3& symmetric);

/// Singular values, descending, and singular vectors (columns) of a matrix, by Jacobi rotations.
class SingularValues {
 public:
  /// `vectors`: Eigen::ComputeThinU, ComputeFullV and the like.
  SingularValues(const Eigen::MatrixXd& matrix, unsigned vectors);

  const Eigen::VectorXd& values() const { return values_; }
  const Eigen::MatrixXd& left() const { return left_; }
  const Eigen::MatrixXd& right() const { return right_; }

 private:
  Eigen::VectorXd values_;
  Eigen::MatrixXd left_, right_;
};

/// Returns the smallest x for which |A x - b| is least; singular values of A below `tolerance` times the largest count
/// as zero.
Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double tolerance);

/// Returns a rotation that turns the unit vector `from` into `to`; none where they are equal, exact between axes of
/// coordinates.
Mat3 rotation_between(const Vec3& from, const Vec3& to);

}  // namespace cgcontact
