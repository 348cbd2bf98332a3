/// Use of friction: closed forms of flat, round and conical contacts, bounds, symmetry.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/motions/sliding.hpp"

namespace cgcontact::test_sliding {
namespace {

/// Flat ring of radii a < b about z through the origin, mu p = 1 Pa, over an angle.
std::vector<FrictionLimit> ring(double a, double b, double turn = 2 * pi) {
  std::vector<FrictionLimit> points;
  const int n = 40, m = static_cast<int>(std::lround(160 * turn / (2 * pi)));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const double r = a + (b - a) * (i + 0.5) / n, angle = turn * (j + 0.5) / m;
      points.push_back({{r * std::cos(angle), r * std::sin(angle), 0}, Vec3::UnitZ(), r * (b - a) / n * turn / m});
    }
  return points;
}

double sum(const std::vector<FrictionLimit>& points) {
  double all = 0;
  for (const FrictionLimit& p : points) all += p.force;
  return all;
}

/// Wrench of friction when all points slide with a motion.
Wrench sliding_with(const std::vector<FrictionLimit>& points, const Vec3& v, const Vec3& w) {
  Wrench wrench;
  for (const FrictionLimit& p : points) {
    Vec3 along = v + w.cross(p.x);
    along -= p.normal.dot(along) * p.normal;
    const Vec3 force = p.force * along.normalized();
    wrench.force += force;
    wrench.moment += p.x.cross(force);
  }
  return wrench;
}

TEST(UseOfFriction, ForceAndTorqueOfAFlatRing) {
  const auto points = ring(1, 2);
  const double force = pi * (4 - 1), torque = 2 * pi * (8 - 1) / 3;
  EXPECT_NEAR(use_of_friction(points, {{0.3 * force, 0.4 * force, 0}, Vec3::Zero()}, {}), 0.5, 1e-12);
  EXPECT_NEAR(use_of_friction(points, {Vec3::Zero(), {0, 0, 0.7 * torque}}, {}), 0.7, 1e-4);  // midpoint rule in r
  EXPECT_EQ(use_of_friction({}, {{1, 0, 0}, Vec3::Zero()}, {}), 0);
  EXPECT_EQ(use_of_friction(points, {Vec3::Zero(), Vec3::Zero()}, {}), 0);
}

// The wrench of points that all slide with one motion is just carried, wherever its axis lies: exact but for the end of
// the iteration (1e-6 a step; points beside the axis of turning converge last).
TEST(UseOfFriction, IsOneWhereAllSlides) {
  const auto points = ring(1, 2);
  for (const Vec3& v : {Vec3(0, 0, 0), Vec3(0.3, 0, 0), Vec3(1, 1, 0), Vec3(0, 5, 0)}) {
    const Wrench wrench = sliding_with(points, v, {0, 0, 1});
    EXPECT_NEAR(use_of_friction(points, wrench, {}), 1, 2e-3) << v.transpose();
    EXPECT_NEAR(use_of_friction(points, {2.5 * wrench.force, 2.5 * wrench.moment}, {}), 2.5, 5e-3);
  }
}

// Shear of any direction below its limit: the use is below 1, and at least that of the force alone.
TEST(UseOfFriction, IsBelowOneWhereShearIs) {
  const auto points = ring(0.2, 2, pi / 2);
  for (int k = 1; k < 20; ++k) {
    Wrench wrench;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double angle = std::sin(k + 0.01 * k * static_cast<double>(i)) * k;
      const Vec3 force = points[i].force * Vec3(std::cos(angle), std::sin(angle), 0);
      wrench.force += force;
      wrench.moment += points[i].x.cross(force);
    }
    const double use = use_of_friction(points, wrench, {});
    EXPECT_LE(use, 1 + 1e-9) << k;
    EXPECT_GE(use, wrench.force.norm() / sum(points) * (1 - 1e-9)) << k;
  }
}

// A cone of revolution pulled along its axis, one point of each ring: the shear acts along the flanks.
TEST(UseOfFriction, ConeAlongItsAxis) {
  const double angle = 0.3;
  std::vector<FrictionLimit> rings;
  for (int i = 0; i < 10; ++i)
    rings.push_back({{1 + 0.1 * i, 0, 0.1 * i / std::tan(angle)}, {std::cos(angle), 0, -std::sin(angle)}, 1 + 0.1 * i});
  const Wrench all{{0, 0, std::cos(angle) * sum(rings)}, Vec3::Zero()};
  EXPECT_NEAR(use_of_friction(around_axis(rings, 2), all, {}), 1, 1e-9);
}

// A quarter of a ring between planes of symmetry, whose force across a plane the other side takes back.
TEST(UseOfFriction, PlanesOfSymmetry) {
  const std::vector<SymmetryPlane> planes{{{0, 0, 0}, -Vec3::UnitX()}, {{0, 0, 0}, -Vec3::UnitY()}};
  const auto quarter = ring(1, 2, pi / 2);
  EXPECT_NEAR(use_of_friction(quarter, {{1, 1, 0}, Vec3::Zero()}, planes), 0, 1e-12);
  const std::vector<SymmetryPlane> half{planes[1]};
  const auto part = ring(1, 2, pi);
  const Wrench push{{0.5 * sum(part), 0.2, 0}, {0, 0, -0.3}};
  EXPECT_NEAR(use_of_friction(part, push, half), 0.5, 1e-9);
}

}  // namespace
}  // namespace cgcontact::test_sliding
