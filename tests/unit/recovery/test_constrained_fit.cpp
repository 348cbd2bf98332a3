/// The constrained patch fit: equality with the dense KKT reference, redundancy, inconsistency.
#include <gtest/gtest.h>

#include <random>

#include "tests/support/constrained_fit.hpp"

namespace cgcontact::test_constrained_fit {
namespace {

using namespace test;

MassMatrix cube_mass(double size, const Vec3& centre) {
  // int {1,x,y,z}^T {1,x,y,z} over a cube of the given size about `centre`.
  Eigen::Vector4d mean(1, centre[0], centre[1], centre[2]);
  MassMatrix m = std::pow(size, 3) * mean * mean.transpose();
  for (int i = 1; i < 4; ++i) m(i, i) += std::pow(size, 5) / 12;
  return m;
}

Eigen::VectorXd random_vector(int n, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd v(n);
  for (int i = 0; i < n; ++i) v[i] = normal(generator);
  return v;
}

Eigen::MatrixXd equilibrium_and_one_face() {
  Eigen::MatrixXd C(12, 24);
  C.topRows<3>() = divergence_rows();
  const Vec3 n = Vec3(1, 2, 2) / 3, t1 = Vec3(2, 1, -2) / 3, t2 = Vec3(2, -2, 1) / 3;
  const Vec3 e[3] = {n, t1, t2};
  const Vec3 points[3] = {0.3 * n, 0.3 * n + 0.4 * t1, 0.3 * n + 0.4 * t2};
  for (int p = 0; p < 3; ++p)
    for (int i = 0; i < 3; ++i) C.row(3 + 3 * p + i) = traction_row(points[p], n, e[i]);
  return C;
}

TEST(ConstrainedFit, EqualsTheDenseKktSolution) {
  for (const bool two_bodies : {false, true}) {
    std::vector<MassMatrix> mass{cube_mass(2, Vec3(0.1, -0.2, 0.3))};
    Eigen::MatrixXd C = equilibrium_and_one_face();
    if (two_bodies) {
      mass.push_back(cube_mass(1.5, Vec3(-0.3, 0.1, 0.2)));
      const Eigen::MatrixXd one = C;
      C = Eigen::MatrixXd::Zero(one.rows() + 4, 48);
      C.topLeftCorner(one.rows(), 24) = one;
      C.block(one.rows(), 24, 3, 24) = divergence_rows();
      const Vec3 n(0, 0, 1);
      C.bottomRows(1).leftCols(24) = traction_row(Vec3(0.2, 0.1, 0), n, n);
      C.bottomRows(1).rightCols(24) = -traction_row(Vec3(0.4, -0.1, 0), n, n);
    }
    const Eigen::VectorXd lambda = random_vector(static_cast<int>(C.rows()), 5);
    Eigen::VectorXd a = random_vector(static_cast<int>(C.cols()), 6), b = a;
    const ConstrainedFitStatus status = constrain_fit(mass, C, lambda, 1e-3, a);
    constrain_fit_kkt(mass, C, lambda, b);
    EXPECT_EQ(status.truncated, 0);
    // Condition of the normalised rows is about 10, squared in the Gram matrix.
    EXPECT_LT((a - b).norm(), 1e-11 * b.norm());
    EXPECT_LT((C * a - lambda).norm(), 1e-11 * b.norm());
  }
}

/// The same solution from the Cholesky factor and, just before rows are truncated, from the eigenvalues.
TEST(ConstrainedFit, BothSolversAgree) {
  const std::vector<MassMatrix> mass{cube_mass(2, Vec3(0.1, -0.2, 0.3))};
  const Eigen::MatrixXd C = equilibrium_and_one_face();
  const Eigen::VectorXd lambda = random_vector(12, 5), a0 = random_vector(24, 6);
  Eigen::VectorXd a = a0, previous = a0;
  constrain_fit(mass, C, lambda, 1e-8, a);
  for (double tolerance = 1e-3; tolerance < 1; tolerance *= 1.1) {
    Eigen::VectorXd b = a0;
    if (constrain_fit(mass, C, lambda, tolerance, b).truncated > 0) {
      EXPECT_GT(tolerance, 0.01);
      break;
    }
    EXPECT_LT((a - b).norm(), 1e-11 * a.norm());
    previous = b;
  }
  EXPECT_NE((a - previous).norm(), 0);  // the last one came from the eigenvalues
}

TEST(ConstrainedFit, RedundantRowsChangeNothingAndAreCounted) {
  const std::vector<MassMatrix> mass{cube_mass(2, Vec3::Zero())};
  const Eigen::MatrixXd C = equilibrium_and_one_face();
  const Eigen::VectorXd lambda = random_vector(12, 7);
  Eigen::MatrixXd doubled(24, 24);
  doubled << C, 2 * C;
  Eigen::VectorXd lambda2(24);
  lambda2 << lambda, 2 * lambda;
  Eigen::VectorXd a = random_vector(24, 8), b = a;
  constrain_fit(mass, C, lambda, 0.01, a);
  const ConstrainedFitStatus status = constrain_fit(mass, doubled, lambda2, 0.01, b);
  EXPECT_EQ(status.truncated, 12);
  EXPECT_FALSE(status.inconsistent);
  EXPECT_LT((a - b).norm(), 1e-11 * a.norm());
}

TEST(ConstrainedFit, ConflictingDataAreMetInLeastSquaresAndReported) {
  const std::vector<MassMatrix> mass{cube_mass(2, Vec3::Zero())};
  Eigen::MatrixXd C(2, 24);
  const Vec3 n(0, 0, 1);
  C.row(0) = traction_row(Vec3::Zero(), n, n);
  C.row(1) = C.row(0);
  Eigen::VectorXd a = Eigen::VectorXd::Zero(24);
  const ConstrainedFitStatus status = constrain_fit(mass, C, Eigen::Vector2d(1, 3), 0.05, a);
  EXPECT_TRUE(status.inconsistent);
  EXPECT_EQ(status.truncated, 1);
  EXPECT_NEAR(C.row(0).dot(a), 2, 1e-12);  // the mean of both
}

TEST(ConstrainedFit, KeepsAFitThatMeetsTheConstraints) {
  const std::vector<MassMatrix> mass{cube_mass(2, Vec3(0.5, 0, 0))};
  const Eigen::MatrixXd C = equilibrium_and_one_face();
  const Eigen::VectorXd a0 = random_vector(24, 9);
  Eigen::VectorXd a = a0;
  constrain_fit(mass, C, C * a0, 0.05, a);
  EXPECT_LT((a - a0).norm(), 1e-13 * a0.norm());
}

}  // namespace
}  // namespace cgcontact::test_constrained_fit
