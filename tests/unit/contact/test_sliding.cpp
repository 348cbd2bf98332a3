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
  EXPECT_NEAR(use_of_friction(points, {{0.3 * force, 0.4 * force, 0}, Vec3::Zero()}), 0.5, 1e-12);
  EXPECT_NEAR(use_of_friction(points, {Vec3::Zero(), {0, 0, 0.7 * torque}}), 0.7, 1e-4);  // midpoint rule in r
  EXPECT_EQ(use_of_friction({}, {{1, 0, 0}, Vec3::Zero()}), 0);
  EXPECT_EQ(use_of_friction(points, {Vec3::Zero(), Vec3::Zero()}), 0);
}

// The wrench of points that all slide with one motion is just carried, wherever its axis lies: exact but for the end of
// the iteration (1e-4 a step; points beside the axis of turning converge last).
TEST(UseOfFriction, IsOneWhereAllSlides) {
  const auto points = ring(1, 2);
  for (const Vec3& v : {Vec3(0, 0, 0), Vec3(0.3, 0, 0), Vec3(1, 1, 0), Vec3(0, 5, 0)}) {
    const Wrench wrench = sliding_with(points, v, {0, 0, 1});
    EXPECT_NEAR(use_of_friction(points, wrench), 1, 2e-3) << v.transpose();
    EXPECT_NEAR(use_of_friction(points, {2.5 * wrench.force, 2.5 * wrench.moment}), 2.5, 5e-3);
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
    const double use = use_of_friction(points, wrench);
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
  EXPECT_NEAR(use_of_friction(rings, all, {{}, 2}), 1, 1e-9);
}

// A round cap that is pressed and slips outwards everywhere: its shear has a resultant along the normals, but the cap
// slides nowhere as a whole.
TEST(UseOfFriction, PressedCap) {
  std::vector<FrictionLimit> points = ring(0, 0.3);
  Wrench wrench;
  for (FrictionLimit& p : points) {
    p.normal = Vec3(p.x[0], p.x[1], 1).normalized();
    p.x[2] = -0.5 * p.x.squaredNorm();
    const Vec3 outwards(p.x[0], p.x[1], 0);
    const Vec3 force = p.force * (outwards - p.normal.dot(outwards) * p.normal).normalized();
    wrench.force += force;
    wrench.moment += p.x.cross(force);
  }
  EXPECT_GT(std::abs(wrench.force[2]), 0.1 * sum(points));
  EXPECT_LT(use_of_friction(points, wrench), 1e-6);
}

// A point far away that carries next to nothing changes next to nothing.
TEST(UseOfFriction, LightPointFarAway) {
  auto points = ring(0, 1);
  const Wrench torque{Vec3::Zero(), {0, 0, 0.9 * 2 * pi / 3}};
  EXPECT_NEAR(use_of_friction(points, torque), 0.9, 1e-3);
  points.push_back({{25, 0, 0}, Vec3::UnitZ(), 1e-6 * sum(points)});
  EXPECT_NEAR(use_of_friction(points, torque), 0.9, 1e-3);
}

// A quarter of a ring between planes of symmetry, whose force across a plane the other side takes back.
TEST(UseOfFriction, PlanesOfSymmetry) {
  const ContactSymmetry quarter{{{{0, 0, 0}, -Vec3::UnitX()}, {{0, 0, 0}, -Vec3::UnitY()}}};
  EXPECT_NEAR(use_of_friction(ring(1, 2, pi / 2), {{1, 1, 0}, Vec3::Zero()}, quarter), 0, 1e-12);
  const ContactSymmetry half{{quarter.planes[1]}};
  const auto part = ring(1, 2, pi);
  EXPECT_NEAR(use_of_friction(part, {{0.5 * sum(part), 0.2, 0}, {0, 0, -0.3}}, half), 0.5, 1e-9);
}

}  // namespace
}  // namespace cgcontact::test_sliding
