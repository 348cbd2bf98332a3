#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/drawing/face_chart.hpp"

namespace cgcontact::test_face_chart {
namespace {

/// A face over a square of parameters in [0, 1], n by n squares of two triangles each.
struct Patch {
  Patch(const std::function<Vec3(double s, double t)>& at, int n = 12) {
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) points.push_back(at(static_cast<double>(i) / n, static_cast<double>(j) / n));
    const auto number = [n](int i, int j) { return i * (n + 1) + j; };
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        face.triangles.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
        face.triangles.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
      }
    face.position = &points;
  }
  std::vector<Vec3> points;
  FaceTriangles face;
};

/// Zone of the unit sphere about the origin, between angles in degrees: of the height, then about z.
Patch sphere(double lowest, double highest, double first, double last) {
  return Patch([=](double s, double t) {
    const double height = (lowest + (highest - lowest) * t) * radians_per_degree;
    const double angle = (first + (last - first) * s) * radians_per_degree;
    return Vec3(std::cos(height) * std::cos(angle), std::cos(height) * std::sin(angle), std::sin(height));
  });
}

// A quarter of a cup is seen along z: its two planes of symmetry are the sides of the picture.
TEST(face_chart, a_quarter_of_a_cup_keeps_its_symmetry) {
  const Patch cup = sphere(-90, -1, 0, 90);
  const FaceChart chart(cup.face);
  EXPECT_EQ(chart.right_name(), "x");
  EXPECT_EQ(chart.up_name(), "y");
  for (const Vec3& x : cup.points) {
    EXPECT_DOUBLE_EQ(chart.position(x)[0], x[0]);
    EXPECT_DOUBLE_EQ(chart.position(x)[1], x[1]);
  }
}

// Some normals of a band around the equator turn away from every axis that is as near: along its mean normal.
TEST(face_chart, a_face_that_would_fold_is_seen_along_its_mean_normal) {
  const Patch band = sphere(-60, 75, -80, 170);
  EXPECT_EQ(FaceChart(band.face).right_name(), "horizontal");
}

// An inclined plane is seen in its true shape.
TEST(face_chart, a_plane_is_not_shortened) {
  const Patch plane([](double s, double t) { return Vec3(s, t, s); });
  const FaceChart chart(plane.face);
  EXPECT_NEAR((chart.position(Vec3(1, 0, 1)) - chart.position(Vec3(0, 0, 0))).head<2>().norm(), std::sqrt(2.0), 1e-12);
}

TEST(face_chart, half_a_bore_is_unrolled) {
  const Patch bore([](double s, double t) { return Vec3(3 * std::cos(pi * s), -3 * std::sin(pi * s), 0.5 * t); });
  const FaceChart chart(bore.face);
  ASSERT_TRUE(chart.unrolled());
  EXPECT_NEAR(std::abs(chart.position(bore.points.front())[0] - chart.position(bore.points.back())[0]), 3 * pi, 1e-9);
  EXPECT_EQ(chart.axis_across(Vec3::UnitZ()), 0);
  for (const Vec3& x : {bore.points.front(), bore.points.back()}) {  // there it runs along y, as a small step says too
    const Vec3 along = chart.direction(0, x);
    EXPECT_NEAR(std::abs(along[1]), 1, 1e-9);
    EXPECT_GT(chart.position(x + 1e-3 * along)[0], chart.position(x)[0]);
  }
}

TEST(face_chart, the_axis_across_a_direction_is_the_other_one) {
  const Patch plane([](double s, double t) { return Vec3(s, t, 0); });
  const FaceChart chart(plane.face);
  EXPECT_EQ(chart.axis_across(Vec3::UnitX()), 1);
  EXPECT_EQ(chart.axis_across(Vec3::UnitY()), 0);
  EXPECT_EQ(chart.direction(0, Vec3::Zero()), Vec3(Vec3::UnitX()));
  EXPECT_EQ(chart.direction(1, Vec3::Zero()), Vec3(Vec3::UnitY()));
}

}  // namespace
}  // namespace cgcontact::test_face_chart
