#include <gtest/gtest.h>

#include <random>

#include "core/base/numbers/decompositions.hpp"

namespace cgcontact::test_decompositions {
namespace {

TEST(Decompositions, rotations_between_axes_are_exact) {
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) {
      const Vec3 from = (i < 3 ? 1 : -1) * Vec3::Unit(i % 3), to = (j < 3 ? 1 : -1) * Vec3::Unit(j % 3);
      const Mat3 turn = rotation_between(from, to);
      EXPECT_EQ(Vec3(turn * from), to);
      EXPECT_EQ(Mat3(turn * turn.transpose()), Mat3(Mat3::Identity()));
      EXPECT_EQ(turn.determinant(), 1);
      EXPECT_TRUE(i != j || turn == Mat3(Mat3::Identity()));
    }
}

TEST(Decompositions, rotations_between_any_directions) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 1000; ++k) {
    const auto direction = [&] { return Vec3(normal(random), normal(random), normal(random)).normalized(); };
    const Vec3 from = direction(), to = k % 3 == 0 ? Vec3(-(from + 1e-7 * direction()).normalized()) : direction();
    const Mat3 turn = rotation_between(from, to);
    // Rounding: some ten operations, nearly opposite directions among them.
    EXPECT_LT((turn * from - to).norm(), 1e-14);
    EXPECT_LT((turn * turn.transpose() - Mat3::Identity()).norm(), 1e-14);
    EXPECT_GT(turn.determinant(), 0);
  }
}

TEST(Decompositions, least_squares_of_dependent_columns_are_the_smallest) {
  Eigen::MatrixXd A(3, 2);
  A << 1, 1, 2, 2, -1, -1;
  const Eigen::VectorXd x = least_squares(A, Eigen::Vector3d(1, 2, -1), 1e-10);
  EXPECT_NEAR(x[0], 0.5, 1e-14);
  EXPECT_NEAR(x[1], 0.5, 1e-14);
}

}  // namespace
}  // namespace cgcontact::test_decompositions
