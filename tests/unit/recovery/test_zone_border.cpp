/// The border of a contact zone from the square of the pressure on patches: exact for Hertz's ellipses and strips.
#include <gtest/gtest.h>

#include <cmath>

#include "recovery/face/zone_border.hpp"

namespace cgcontact::test_zone_border {
namespace {

FaceGrid grid_of(int rows, int columns, double spacing, bool plane_strain = false) {
  FaceGrid grid;
  grid.size = {rows, columns};
  grid.spacing = {spacing, spacing};
  grid.low = FacePosition(-0.5 * rows * spacing, -0.5 * columns * spacing);
  if (plane_strain) {
    grid.plane_strain = true;
    grid.spacing[0] = 1;
    grid.low[0] = -0.5;
  }
  return grid;
}

template <class Square>
std::vector<double> values(const FaceGrid& grid, const Square& square) {
  std::vector<double> result;
  for (int n = 0; n < grid.num_patches(); ++n) result.push_back(square(grid.centre(n)));
  return result;
}

/// Half axes of 3 and 1.7 about a point between the patches: position, direction, slope and curvature of an ellipse, up
/// to rounding of the fit (squares of positions of 1e-1, sums of hundreds).
TEST(ZoneBorder, OfAnEllipseIsExact) {
  const FaceGrid grid = grid_of(90, 90, 0.1);
  const FacePosition middle(0.13, -0.07);
  const double a = 3, b = 1.7, peak = 4e6;
  const auto square = [&](const FacePosition& x) {
    const FacePosition d = x - middle;
    return peak * (1 - std::pow(d[0] / a, 2) - std::pow(d[1] / b, 2));
  };
  const std::vector<char> inside(grid.num_patches(), 1);
  const auto border = border_of_zone(grid, values(grid, square), inside, 1.2);
  EXPECT_GT(border.size(), 100u);
  double low = 1e300, high = -1e300;
  for (const BorderPoint& point : border) {
    const FacePosition d = point.position - middle, gradient(-2 * peak * d[0] / (a * a), -2 * peak * d[1] / (b * b));
    EXPECT_NEAR(square(point.position), 0, 1e-8 * peak);
    EXPECT_NEAR((point.inward - gradient.normalized()).norm(), 0, 1e-8);
    EXPECT_NEAR(point.slope, gradient.norm(), 1e-8 * gradient.norm());
    const double t = std::atan2(d[1] / b, d[0] / a);
    const double curvature = -a * b / std::pow(std::pow(a * std::sin(t), 2) + std::pow(b * std::cos(t), 2), 1.5);
    EXPECT_NEAR(point.curvature, curvature, 1e-7 * std::abs(curvature));
    const FacePosition n = point.inward;
    EXPECT_NEAR(point.inverse_width, peak * (std::pow(n[0] / a, 2) + std::pow(n[1] / b, 2)) / gradient.norm(), 1e-7);
    low = std::min(low, t);
    high = std::max(high, t);
  }
  EXPECT_GT(high - low, 6);  // all around
}

/// A quarter between two symmetry planes: the images behind them count, so that it is the same border.
TEST(ZoneBorder, GoesOnBehindSymmetryPlanes) {
  FaceGrid grid = grid_of(40, 40, 0.1);
  grid.low = FacePosition::Zero();
  grid.end = {FaceEnd::mirror, FaceEnd::mirror};
  const auto square = [](const FacePosition& x) { return 9 - x.squaredNorm(); };
  const std::vector<char> inside(grid.num_patches(), 1);
  const auto border = border_of_zone(grid, values(grid, square), inside, 1.5);
  EXPECT_GT(border.size(), 40u);
  for (const BorderPoint& point : border) {
    EXPECT_NEAR(point.position.norm(), 3, 1e-9);
    EXPECT_NEAR(point.curvature, -1. / 3, 1e-8);
  }
}

/// Plane strain: two ends; the width is that of the zone.
TEST(ZoneBorder, OfAStripHasTwoEnds) {
  const FaceGrid grid = grid_of(1, 80, 0.1, true);
  const auto square = [](const FacePosition& x) { return 4 - std::pow(x[1] - 0.32, 2); };
  const std::vector<char> inside(grid.num_patches(), 1);
  const auto border = border_of_zone(grid, values(grid, square), inside, 1.5);
  ASSERT_EQ(border.size(), 2u);
  for (const BorderPoint& point : border) {
    EXPECT_NEAR(std::abs(point.position[1] - 0.32), 2, 1e-9);
    EXPECT_NEAR(point.inward[1], point.position[1] > 0 ? -1 : 1, 1e-12);
    EXPECT_NEAR(point.inverse_width, 0.25, 1e-9);
    EXPECT_EQ(point.curvature, 0);
  }
}

/// Where a face ends inside a zone there is no border, nor where all of it is pressed or nothing is.
TEST(ZoneBorder, IsNoneWhereTheFaceEnds) {
  const FaceGrid grid = grid_of(40, 40, 0.1);
  const auto square = [](const FacePosition& x) { return 1.0 + 0.1 * x[0]; };
  std::vector<char> inside(grid.num_patches(), 1);
  for (int n = 0; n < grid.num_patches(); ++n) inside[n] = grid.centre(n).norm() < 1;
  EXPECT_TRUE(border_of_zone(grid, values(grid, square), inside, 1.5).empty());
  EXPECT_TRUE(border_of_zone(grid, std::vector<double>(grid.num_patches(), -1.0), inside, 1.5).empty());
}

}  // namespace
}  // namespace cgcontact::test_zone_border
