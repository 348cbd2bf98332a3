#include <gtest/gtest.h>

#include <cmath>

#include "core/drawing/curve_ends.hpp"

namespace cgcontact::test_curve_ends {
namespace {

const SymmetryPlane at_zero{Vec3::Zero(), -Vec3::UnitX()};  // the body is at x > 0

/// The end of a curve at (0.05, 2, 3) whose coordinate is 7 there.
CurveTip tip(const Vec3& outward) { return {7, {0.05, 2, 3}, outward, -2 * outward.norm()}; }

// Half a step is left to the plane; a step changes the coordinate by -0.2.
TEST(curve_ends, a_curve_across_a_plane_is_mirrored_there) {
  const auto end = end_at_plane(tip({-0.1, 0, 0}), {at_zero});
  ASSERT_TRUE(end);
  EXPECT_TRUE(end->across);
  EXPECT_NEAR(end->s, 6.9, 1e-14);
  EXPECT_NEAR(end->mirrored(7), 6.8, 1e-14);
  EXPECT_NEAR(end->mirrored(9), 4.8, 1e-14);
}

TEST(curve_ends, the_mirror_image_begins_with_the_end_of_the_curve) {
  const CurveEnd end{at_zero, 0.5, true};
  const std::vector<CurvePoint> image{{1, 30}, {0, 30}, {-1, 20}, {-2, 10}};
  EXPECT_EQ(mirror_image({{1, 30}, {2, 20}, {3, 10}}, end), image);
  const CurveEnd other{at_zero, 3.5, true};
  const std::vector<CurvePoint> of_last{{3, 10}, {4, 10}, {5, 20}, {6, 30}};
  EXPECT_EQ(mirror_image({{1, 30}, {2, 20}, {3, 10}}, other), of_last);
  EXPECT_TRUE(mirror_image({}, end).empty());
}

TEST(curve_ends, a_curve_that_is_not_across_ends_at_the_plane) {
  const auto end = end_at_plane(tip({-0.1, 0.1, 0}), {at_zero});
  ASSERT_TRUE(end);
  EXPECT_FALSE(end->across);
  EXPECT_NEAR(end->s, 7 - std::sqrt(0.02), 1e-14);
}

TEST(curve_ends, others_end_elsewhere) {
  EXPECT_FALSE(end_at_plane(tip({-0.04, 0, 0}), {at_zero}));  // one more step stays before the plane
  EXPECT_FALSE(end_at_plane(tip({0.1, 0, 0}), {at_zero}));    // away from it
  EXPECT_FALSE(end_at_plane(tip({0, 0.1, 0}), {at_zero}));    // along it
  EXPECT_FALSE(end_at_plane({0, Vec3::Zero(), {-1e-12, 0.1, 0}, 0.1}, {at_zero}));  // along it, in it
  EXPECT_FALSE(end_at_plane(tip(Vec3::Zero()), {at_zero}));                         // a single point
  EXPECT_FALSE(end_at_plane(tip({-0.1, 0, 0}), {}));
}

TEST(curve_ends, planes_are_named_by_their_axis) {
  EXPECT_EQ(name_of(at_zero, 1), "x = 0");
  EXPECT_EQ(name_of(SymmetryPlane{{0, 1e-14, 0}, Vec3::UnitY()}, 0.02), "y = 0");
  EXPECT_EQ(name_of(SymmetryPlane{{9, 9, -0.0025}, Vec3::UnitZ()}, 0.02), "z = -2.5 mm");
  EXPECT_EQ(name_of(SymmetryPlane{Vec3::Zero(), Vec3(1, 1, 0).normalized()}, 0.02), "a plane of symmetry");
}

}  // namespace
}  // namespace cgcontact::test_curve_ends
