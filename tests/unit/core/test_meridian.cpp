/// Sections of bodies of revolution: the same points as in the body, faces keep their names; others are refused.
#include <gtest/gtest.h>

#include <random>

#include "core/base/errors/errors.hpp"
#include "core/bodies/meridian.hpp"
#include "core/bodies/profile_body.hpp"

namespace cgcontact::test_meridian {
namespace {

/// A turned part with all kinds of faces about an axis through the origin.
Solid turned(int axis) {
  const Vec3 e = Vec3::Unit(axis);
  const Solid whole = Solid::unite(Solid::cylinder(-0.5 * e, 0.5 * e, 0.4, "rod"), Solid::sphere(0.5 * e, 0.3, "ball"));
  const Solid drilled = Solid::subtract(whole, Solid::cone(-0.6 * e, 0.2 * e, 0.25, 0.05, "drill"));
  return Solid::subtract(drilled, Solid::half_space(-0.45 * e, e, "end"));
}

TEST(Meridian, HoldsTheSamePoints) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> along(-0.7, 1), away(0, 0.6), across(-0.4, 0.4);
  for (const int axis : {0, 1, 2}) {
    const Solid body = turned(axis), section = meridian_of(body, axis);
    for (int i = 0; i < 2000; ++i) {
      Vec3 x;
      x[axis] = along(random);
      x[(axis + 1) % 3] = away(random);
      x[(axis + 2) % 3] = 0;
      const bool inside = body.contains(x);
      x[(axis + 2) % 3] = across(random);
      EXPECT_EQ(section.contains(x), inside) << x.transpose();
      x[(axis + 1) % 3] = -away(random) - 1e-9;
      EXPECT_FALSE(section.contains(x));
    }
    for (const char* name : {"rod.side", "ball.surface", "drill.side", "axis.plane"})
      EXPECT_TRUE(std::any_of(section.surfaces().begin(), section.surfaces().end(), [&](const Surface& surface) {
        return std::find(surface.names.begin(), surface.names.end(), name) != surface.names.end();
      })) << name;
  }
}

TEST(Meridian, PlanesBeyondTheBodyBoundNothing) {
  const Solid ball = Solid::sphere(Vec3(0, 0, 1), 1, "ball");
  const Solid half = Solid::intersect(ball, Solid::box(Vec3(-2, -2, -0.5), Vec3(2, 2, 1), "box"));
  const Solid section = meridian_of(half, 2);
  EXPECT_TRUE(section.contains(Vec3(0.9, 0, 0.99)));
  EXPECT_FALSE(section.contains(Vec3(0.5, 0, 1.01)));
}

TEST(Meridian, APrismIsItsOwnSection) {
  const Solid section = meridian_of(Solid::box(Vec3(1, -0.2, 0), Vec3(2, 0.2, 3), "ring"), 2);
  EXPECT_TRUE(section.contains(Vec3(1.5, 0, 1)));
  EXPECT_FALSE(section.contains(Vec3(0.5, 0, 1)));
}

TEST(Meridian, OtherBodiesAreRefused) {
  const auto refused = [](const Solid& solid, const std::string& words) {
    try {
      meridian_of(solid, 2);
      ADD_FAILURE() << words;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refused(Solid::sphere(Vec3(0.1, 0, 0), 1, "ball"), "\"ball.surface\" is not of revolution");
  refused(Solid::cylinder(Vec3(0, 0, 0), Vec3(1, 0, 0), 1, "rod"), "is not of revolution");
  refused(Solid::box(Vec3(-1, -1, 0), Vec3(1, 1, 1), "box"), "must lie on one side");
  refused(
      Solid::intersect(Solid::sphere(Vec3(0, 0, 0), 1, "ball"), Solid::box(Vec3(-0.9, -2, -2), Vec3(2, 2, 2), "box")),
      "\"box.x-\" is not of revolution");
  refused(Solid::intersect(turned(2), Solid::half_space(Vec3(0.1, 0, 0), Vec3(1, 0, 0), "cut")),
          "\"cut.plane\" is not of revolution");
}

}  // namespace
}  // namespace cgcontact::test_meridian
