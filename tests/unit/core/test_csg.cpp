// Solids: membership, merging of coincident surfaces, bounding boxes, bad input.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/errors/errors.hpp"
#include "core/bodies/csg_body.hpp"

namespace cgcontact::test_csg {
namespace {

Mat3 rotation(const Vec3& axis, double angle) { return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(); }

bool has_name(const Surface& surface, const std::string& name) {
  for (const std::string& n : surface.names)
    if (n == name) return true;
  return false;
}

// Proves that every primitive knows inside from outside; points keep a clear distance, so no tolerance is involved.
TEST(Csg, PrimitivesContainTheirPoints) {
  const Solid box = Solid::box({0, 0, 0}, {1, 2, 3}, "b");
  EXPECT_TRUE(box.contains({0.5, 1.9, 2.9}));
  EXPECT_FALSE(box.contains({0.5, 2.1, 1}));
  EXPECT_TRUE(box.contains({1, 1, 1})) << "surfaces count as inside";
  const Solid cylinder = Solid::cylinder({0, 0, 1}, {0, 0, 4}, 2, "c");
  EXPECT_TRUE(cylinder.contains({1.9, 0, 1.1}));
  EXPECT_FALSE(cylinder.contains({1.9, 0, 0.9}));
  EXPECT_FALSE(cylinder.contains({1.5, 1.5, 2}));
  const Solid half = Solid::half_space({0, 0, 1}, {0, 0, 2}, "h");
  EXPECT_TRUE(half.contains({100, -5, 0.9}));
  EXPECT_FALSE(half.contains({0, 0, 1.1}));
}

// Proves the face names that loads and supports refer to.
TEST(Csg, FacesAreNamed) {
  const Solid box = Solid::box({0, 0, 0}, {1, 1, 1}, "b");
  const char* names[] = {"b.x-", "b.x+", "b.y-", "b.y+", "b.z-", "b.z+"};
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(box.surfaces()[i].names, std::vector<std::string>{names[i]});
    EXPECT_EQ(box.surfaces()[i].direction[i / 2], i % 2 == 0 ? -1.0 : 1.0);
  }
  const Solid cylinder = Solid::cylinder({0, 0, 1}, {0, 0, 4}, 2, "c");
  EXPECT_TRUE(has_name(cylinder.surfaces()[0], "c.side"));
  EXPECT_TRUE(has_name(cylinder.surfaces()[1], "c.bottom"));
  EXPECT_TRUE(has_name(cylinder.surfaces()[2], "c.top"));
}

// Proves that a ring has four surfaces: the end caps of both cylinders are one each, even after rounding by a rotation.
TEST(Csg, RingSharesItsCaps) {
  const Mat3 r = rotation({1, -2, 0.5}, 1.1);
  const Vec3 a(0.1, 0.2, 0.3), axis = r.col(2);
  const Solid ring = Solid::subtract(Solid::cylinder(a, a + 0.7 * axis, 0.5, "outer"),
                                     Solid::cylinder(a + 1e-16 * axis, a + 0.7 * axis, 0.3, "inner"));
  ASSERT_EQ(ring.surfaces().size(), 4u);
  EXPECT_TRUE(has_name(ring.surfaces()[1], "outer.bottom"));
  EXPECT_TRUE(has_name(ring.surfaces()[1], "inner.bottom"));
  // with all other signs fixed inside the ring's wall or hole, only the wall changes across a cap
  EXPECT_TRUE(as_csg(ring)->evaluate({1, 1, 1, 0}));
  EXPECT_FALSE(as_csg(ring)->evaluate({1, 0, 1, 0}));
  EXPECT_FALSE(as_csg(ring)->evaluate({1, 1, 1, 1}));
  EXPECT_FALSE(as_csg(ring)->evaluate({1, 0, 1, 1}));
}

// Proves that two boxes with a common face share it with opposite sides, and that it is no boundary of the union.
TEST(Csg, OppositeFacesBecomeComplements) {
  const Solid both = Solid::unite(Solid::box({0, 0, 0}, {1, 1, 1}, "low"), Solid::box({0, 0, 1}, {1, 1, 2}, "high"));
  ASSERT_EQ(both.surfaces().size(), 7u);
  int shared = -1;
  for (int i = 0; i < 7; ++i)
    if (has_name(both.surfaces()[i], "low.z+")) shared = i;
  ASSERT_GE(shared, 0);
  EXPECT_TRUE(has_name(both.surfaces()[shared], "high.z-"));
  std::vector<char> inner(7, 1);
  EXPECT_TRUE(as_csg(both)->evaluate(inner));
  inner[shared] = 0;
  EXPECT_TRUE(as_csg(both)->evaluate(inner)) << "above the common face";
}

// Proves that surfaces which differ by more than rounding stay apart.
TEST(Csg, CloseSurfacesStayApart) {
  const Solid a = Solid::box({0, 0, 0}, {1, 1, 1}, "a"), b = Solid::box({0, 0, 0}, {1, 1, 1 + 1e-9}, "b");
  EXPECT_EQ(Solid::intersect(a, b).surfaces().size(), 7u);
  EXPECT_EQ(Solid::unite(Solid::sphere({0, 0, 0}, 1, "s"), Solid::sphere({0, 0, 1e-9}, 1, "t")).surfaces().size(), 2u);
  EXPECT_EQ(Solid::unite(Solid::sphere({0, 0, 0}, 1, "s"), Solid::sphere({0, 0, 1e-15}, 1, "t")).surfaces().size(), 1u);
}

// Proves the logic of partly known signs: it must never claim more than all completions agree on.
TEST(Csg, PartialEvaluationIsConservative) {
  const Solid solid = Solid::subtract(Solid::unite(Solid::sphere({0, 0, 0}, 1, "a"), Solid::sphere({1, 0, 0}, 1, "b")),
                                      Solid::sphere({0, 1, 0}, 0.5, "c"));
  for (int code = 0; code < 27; ++code) {
    const std::vector<signed char> sides{static_cast<signed char>(code % 3 - 1),
                                         static_cast<signed char>(code / 3 % 3 - 1),
                                         static_cast<signed char>(code / 9 - 1)};
    bool some_in = false, some_out = false;
    for (int mask = 0; mask < 8; ++mask) {
      std::vector<char> full;
      for (int i = 0; i < 3; ++i) full.push_back(sides[i] < 0 ? static_cast<char>(mask >> i & 1) : sides[i]);
      (as_csg(solid)->evaluate(full) ? some_in : some_out) = true;
    }
    const int value = as_csg(solid)->evaluate_partial(sides);
    EXPECT_EQ(value, some_in && some_out ? -1 : some_in ? 1 : 0);
  }
}

// Proves that bounding boxes are tight for placed primitives; 1e-14 is a few units in the last place of coordinates ~3.
TEST(Csg, BoundingBoxesAreTight) {
  const Mat3 r = rotation({3, 1, -2}, 0.8);
  Vec3 min, max;
  ASSERT_TRUE(Solid::sphere({1, 2, 3}, 0.5, "s").transformed(r, Vec3(0, 0, 1), 2).bounding_box(min, max));
  const Vec3 centre = 2 * (r * Vec3(1, 2, 3)) + Vec3(0, 0, 1);
  EXPECT_LT((min - (centre - Vec3::Ones())).norm(), 1e-14);
  EXPECT_LT((max - (centre + Vec3::Ones())).norm(), 1e-14);

  ASSERT_TRUE(Solid::box({-1, -2, -3}, {1, 2, 3}, "b").transformed(r, Vec3::Zero()).bounding_box(min, max));
  EXPECT_LT((max - r.cwiseAbs() * Vec3(1, 2, 3)).norm(), 1e-14);

  ASSERT_TRUE(Solid::cylinder({0, 0, -1}, {0, 0, 1}, 2, "c").transformed(r, Vec3::Zero()).bounding_box(min, max));
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(max[k], std::abs(r(k, 2)) + 2 * std::hypot(r(k, 0), r(k, 1)), 1e-14);
}

// Proves the rules for booleans and for unbounded solids.
TEST(Csg, BoundingBoxesOfBooleans) {
  Vec3 min, max;
  const Solid half = Solid::half_space({0, 0, 1}, {0, 0, 1}, "h"), box = Solid::box({-1, -1, -1}, {3, 3, 3}, "b");
  EXPECT_FALSE(half.bounding_box(min, max));
  EXPECT_FALSE(Solid::unite(half, box).bounding_box(min, max));
  ASSERT_TRUE(Solid::intersect(half, box).bounding_box(min, max));
  EXPECT_EQ(max, Vec3(3, 3, 1));
  EXPECT_EQ(min, Vec3(-1, -1, -1));
  ASSERT_TRUE(Solid::subtract(box, half).bounding_box(min, max));
  EXPECT_EQ(max, Vec3(3, 3, 3));
  ASSERT_TRUE(Solid::unite(box, Solid::sphere({5, 0, 0}, 1, "s")).bounding_box(min, max));
  EXPECT_EQ(max, Vec3(6, 3, 3));
}

// Proves the line intersections used by visualisation and the gap search, for generic, tangent and missing lines.
TEST(Csg, LinesMeetSurfaces) {
  double t[2];
  const Surface sphere = Solid::sphere({0, 0, 0}, 2, "s").surfaces()[0];
  ASSERT_EQ(sphere.intersect_line({-5, 0, 0}, {1, 0, 0}, t), 2);
  EXPECT_DOUBLE_EQ(t[0], 3);
  EXPECT_DOUBLE_EQ(t[1], 7);
  EXPECT_EQ(sphere.intersect_line({-5, 3, 0}, {1, 0, 0}, t), 0);
  const Surface side = Solid::cylinder({0, 0, 0}, {0, 0, 1}, 2, "c").surfaces()[0];
  ASSERT_EQ(side.intersect_line({0, 0, 50}, {1, 0, 1}, t), 2);
  EXPECT_DOUBLE_EQ(t[0], -2);
  EXPECT_DOUBLE_EQ(t[1], 2);
  EXPECT_EQ(side.intersect_line({1, 0, 0}, {0, 0, 1}, t), 0) << "parallel to the axis";
  const Surface plane = Solid::half_space({0, 0, 1}, {0, 0, 1}, "h").surfaces()[0];
  ASSERT_EQ(plane.intersect_line({0, 0, 0}, {0, 1, 2}, t), 1);
  EXPECT_DOUBLE_EQ(t[0], 0.5);
  EXPECT_EQ(plane.intersect_line({0, 0, 0}, {1, 0, 0}, t), 0);
}

// Proves that nonsense is refused with a message instead of being integrated.
TEST(Csg, NonsenseIsRefused) {
  EXPECT_THROW(Solid::box({0, 0, 0}, {1, 0, 1}, "b"), InputError);
  EXPECT_THROW(Solid::box({0, 0, 0}, {1, -1, 1}, "b"), InputError);
  EXPECT_THROW(Solid::sphere({0, 0, 0}, 0, "s"), InputError);
  EXPECT_THROW(Solid::sphere({0, 0, std::nan("")}, 1, "s"), InputError);
  EXPECT_THROW(Solid::cylinder({0, 0, 0}, {0, 0, 0}, 1, "c"), InputError);
  EXPECT_THROW(Solid::cylinder({0, 0, 0}, {0, 0, 1}, -1, "c"), InputError);
  EXPECT_THROW(Solid::half_space({0, 0, 0}, {0, 0, 0}, "h"), InputError);
  EXPECT_THROW(Solid::sphere({0, 0, 0}, 1, "s").transformed(2 * Mat3::Identity(), Vec3::Zero()), InputError);
  EXPECT_THROW(Solid::sphere({0, 0, 0}, 1, "s").transformed(Mat3::Identity(), Vec3::Zero(), 0), InputError);
}

}  // namespace
}  // namespace cgcontact::test_csg
