// Polygons as triangles: convex ones in a fan, others by ears, and what is no simple polygon.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "core/triangles/polygon_triangles.hpp"

namespace cgcontact::test_polygon_triangles {
namespace {

Vec3 area_vector(const std::vector<Vec3>& x, const std::vector<Triangle>& triangles) {
  Vec3 sum = Vec3::Zero();
  for (const Triangle& t : triangles) sum += (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]) / 2;
  return sum;
}

// Proves that triangles of star-shaped polygons with inward corners, in any plane and from any first corner, have the
// polygon's area, all turned the same way: no two of them overlap.
TEST(PolygonTriangles, InwardCorners) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(0.2, 1);
  for (int sample = 0; sample < 200; ++sample) {
    const int n = 4 + sample % 17;
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(uniform(generator), uniform(generator), -uniform(generator), 1).normalized();
    std::vector<Vec3> x;
    double area = 0;
    std::vector<double> radius;
    for (int i = 0; i < n; ++i) radius.push_back(uniform(generator));
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * pi * i / n;
      x.push_back(turn * Vec3(radius[i] * std::cos(angle), radius[i] * std::sin(angle), 3));
      area += radius[i] * radius[(i + 1) % n] * std::sin(2 * pi / n) / 2;
    }
    const std::vector<Triangle> triangles = polygon_triangles(x);
    ASSERT_EQ(triangles.size(), x.size() - 2);
    double sum = 0;
    for (const Triangle& t : triangles) sum += area_vector(x, {t}).norm();
    EXPECT_NEAR(sum, area, 1e-9);
    EXPECT_NEAR(area_vector(x, triangles).norm(), area, 1e-9);
  }
}

// Proves that convex polygons stay a fan, and that polygons with corners on straight edges next to inward ones, with a
// hole on a bridge, and crossing ones come out right.
TEST(PolygonTriangles, OtherPolygons) {
  const std::vector<Vec3> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_EQ(polygon_triangles(square), (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  const std::vector<Vec3> angle{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}};
  EXPECT_NEAR(area_vector(angle, polygon_triangles(angle)).norm(), 3, 1e-12);
  const std::vector<Vec3> frame{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 0, 0},
                                {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}, {1, 1, 0}};
  EXPECT_NEAR(area_vector(frame, polygon_triangles(frame)).norm(), 8, 1e-12);
  EXPECT_TRUE(polygon_triangles({{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {2, 2, 0}}).empty());
  EXPECT_TRUE(polygon_triangles({{0, 0, 0}, {1, 0, 0}}).empty());
}

}  // namespace
}  // namespace cgcontact::test_polygon_triangles
