/// Where expressions jump: planes in a box, of every comparison that is linear there.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/expressions/jump_planes.hpp"

namespace cgcontact::test_jump_planes {
namespace {

const SourceLocation location{"scene.toml", 7, "pressure"};

std::vector<JumpPlane> planes_of(const std::string& text, const Constants& constants = {}) {
  return jump_planes(Expression(text, location, constants), Vec3(-0.02, -0.03, 0), Vec3(0.04, 0.02, 0.05));
}

/// Tells whether the plane normal . x = offset is among them, either way round.
bool has(const std::vector<JumpPlane>& planes, const Vec3& normal, double offset) {
  return std::any_of(planes.begin(), planes.end(), [&](const JumpPlane& p) {
    const double sign = p.normal.dot(normal) < 0 ? -1 : 1;
    return (sign * p.normal - normal.normalized()).norm() < 1e-9 &&
           std::abs(sign * p.offset - offset / normal.norm()) < 1e-11;
  });
}

TEST(JumpPlanes, LinearComparisonsGiveTheirPlanes) {
  EXPECT_TRUE(has(planes_of("x < 0.01 ? 1e5 : 3e5"), Vec3(1, 0, 0), 0.01));
  EXPECT_TRUE(has(planes_of("1e5*(2*x - y + 0.5*z >= 0.013)"), Vec3(2, -1, 0.5), 0.013));
  EXPECT_TRUE(has(planes_of("1 bar*(z > 20 mm)"), Vec3(0, 0, 1), 0.02));
  EXPECT_TRUE(has(planes_of("sign(y - w)", {{"w", 0.004}}), Vec3(0, 1, 0), 0.004));
  const auto strip = planes_of("x > -0.005 && x <= 0.015 ? 2 : 0");
  EXPECT_EQ(strip.size(), 2u);
  EXPECT_TRUE(has(strip, Vec3(1, 0, 0), -0.005) && has(strip, Vec3(1, 0, 0), 0.015));
  const auto nested = planes_of("x < 0 ? (y < 0.01 ? 1 : 2) : (z < 0.03 || z > 0.04)*3");
  EXPECT_EQ(nested.size(), 4u);
}

// max(|x|, |y|) < c: a square, linear in regions of the box.
TEST(JumpPlanes, OfPiecewiseLinearValues) {
  const auto square = planes_of("max(abs(x), abs(y)) < 6 mm ? 1 bar : 0");
  EXPECT_EQ(square.size(), 4u);
  for (const double side : {1.0, -1.0}) {
    EXPECT_TRUE(has(square, Vec3(1, 0, 0), side * 0.006));
    EXPECT_TRUE(has(square, Vec3(0, 1, 0), side * 0.006));
  }
}

TEST(JumpPlanes, NothingElseDoes) {
  for (const char* text : {"1e5", "1e5*x", "x^2 + y^2 < 1e-4 ? 1 : 0", "x*y < 1e-4 ? 1 : 0", "3 > 2 ? x : y",
                           "max(x, y)", "x == y ? 1 : 0", "sqrt(x) < 0.1*x^2 ? 1 : 2"})
    EXPECT_TRUE(planes_of(text).empty()) << text;
}

}  // namespace
}  // namespace cgcontact::test_jump_planes
