/// Boolean operations with triangle surfaces: the bodies, areas and names that the same operations of CSG shapes give.
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "core/base/errors/errors.hpp"
#include "core/bodies/booleans.hpp"
#include "core/bodies/triangle_body.hpp"
#include "tests/support/triangle_shapes.hpp"

namespace cgcontact::test_triangle_booleans {
namespace {

constexpr double cell_size = 0.1;

/// The soup as a body whose single face is "part.rest".
Solid body(const TriangleSoup& soup) {
  return Solid::bounded_by(make_surface(soup, name_faces(soup, "part", {}), default_crease_angle));
}

Solid cube(const Vec3& min = Vec3::Zero(), const Vec3& max = Vec3::Ones()) { return body(test::box_soup(min, max)); }

double volume(const Solid& solid) {
  const TriangleSurface& surface = *as_triangles(solid);
  const Vec3 origin = surface.points()[0];
  double sum = 0;
  for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t)
    sum +=
        (surface.corner(t, 0) - origin).dot((surface.corner(t, 1) - origin).cross(surface.corner(t, 2) - origin)) / 6;
  return sum;
}

std::map<std::string, double> areas(const Solid& solid) {
  const TriangleSurface& surface = *as_triangles(solid);
  std::map<std::string, double> area;
  for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t)
    area[surface.face_names()[surface.patch(t)]] +=
        (surface.corner(t, 1) - surface.corner(t, 0)).cross(surface.corner(t, 2) - surface.corner(t, 0)).norm() / 2;
  return area;
}

std::string error_of(BooleanOp::Kind op, const Solid& a, const Solid& b) {
  try {
    combine_triangles(op, a, b, cell_size);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Proves that planes cut exactly, wherever they lie: a cube halved, and halved again, at 15 random attitudes. Rounding
// of the coordinates is all that 1e-13 allows for.
TEST(TriangleBooleans, PlanesCutExactly) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto direction = [&] { return Vec3(uniform(random), uniform(random), uniform(random)).normalized(); };
  for (int pose = 0; pose < 15; ++pose) {
    const Mat3 rotation = Eigen::AngleAxisd(pi * uniform(random), direction()).toRotationMatrix();
    const Vec3 shift = 5 * direction();
    const auto placed = [&](const Solid& solid) { return solid.transformed(rotation, shift); };
    const Vec3 normal(1, 0.3 * uniform(random), 0.3 * uniform(random));
    const Solid plane = placed(Solid::half_space({0.5, 0.5, 0.5}, normal.normalized(), "cut"));
    const Solid box = placed(Solid::box({-1, -1, -1}, {2, 0.5, 2}, "box"));
    const auto half = combine_triangles(BooleanOp::Kind::intersect, placed(cube()), plane, cell_size);
    EXPECT_NEAR(volume(half.solid), 0.5, 1e-13);
    EXPECT_EQ(half.facet_error, 0);
    auto area = areas(half.solid);
    EXPECT_NEAR(area["cut.plane"], normal.norm(), 1e-12);
    EXPECT_NEAR(area["part.rest"], 3, 1e-12);  // half of every face, by symmetry
    const auto quarter = combine_triangles(BooleanOp::Kind::subtract, half.solid, box, cell_size);
    const auto other = combine_triangles(BooleanOp::Kind::intersect, half.solid, box, cell_size);
    EXPECT_NEAR(volume(quarter.solid) + volume(other.solid), 0.5, 1e-13);
    EXPECT_NEAR(areas(quarter.solid)["box.y+"], areas(other.solid)["box.y+"], 1e-12);
  }
}

// Proves that a bore and a dimple have the volume of cylinder and sphere up to the facets' distance from them, and that
// this distance is a thousandth of a cell.
TEST(TriangleBooleans, CurvedShapesComeInFacets) {
  const Solid bore = Solid::cylinder({0.5, 0.5, -1}, {0.5, 0.5, 2}, 0.3, "bore");
  const auto drilled = combine_triangles(BooleanOp::Kind::subtract, cube(), bore, cell_size);
  EXPECT_GT(drilled.facet_error, 0);
  EXPECT_LE(drilled.facet_error, 1e-3 * cell_size);
  const double wall = 2 * pi * 0.3;
  EXPECT_NEAR(volume(drilled.solid), 1 - pi * 0.09, wall * drilled.facet_error);
  EXPECT_NEAR(areas(drilled.solid)["bore.side"], wall, 1e-3);
  EXPECT_EQ(areas(drilled.solid).count("bore.top"), 0u);
  const Solid ball = Solid::sphere({0.5, 0.5, 1}, 0.3, "ball");
  const auto joined = combine_triangles(BooleanOp::Kind::unite, cube(), ball, cell_size);
  EXPECT_LE(joined.facet_error, 1e-3 * cell_size);
  const double cap = 2 * pi * 0.09;
  EXPECT_NEAR(volume(joined.solid), 1 + 2 * pi / 3 * 0.027, cap * joined.facet_error);
  EXPECT_NEAR(areas(joined.solid)["ball.surface"], cap, 1e-3);
}

// Proves that faces that are meant to coincide do: boxes that stand on the cube's faces, cubes that came out of a file
// with coordinates in thousandths, with rounding.
TEST(TriangleBooleans, FacesMayCoincide) {
  TriangleSoup soup = test::box_soup({10, 20, 70}, {40, 90, 110});
  for (Vec3& x : soup.points) x *= 1e-3;
  const Solid part = body(soup);
  const Solid foot = Solid::box({0, 0, 0.06}, {0.06, 0.12, 0.07}, "foot");
  const auto standing = combine_triangles(BooleanOp::Kind::unite, part, foot, cell_size);
  EXPECT_NEAR(volume(standing.solid), 0.03 * 0.07 * 0.04 + 0.06 * 0.12 * 0.01, 1e-15);
  EXPECT_NEAR(areas(standing.solid)["foot.z+"], 0.06 * 0.12 - 0.03 * 0.07, 1e-14);
  const Solid slice = Solid::box({0.01, 0.02, 0.08}, {0.04, 0.09, 0.11}, "slice");
  const auto rest = combine_triangles(BooleanOp::Kind::subtract, part, slice, cell_size);
  EXPECT_NEAR(volume(rest.solid), 0.03 * 0.07 * 0.01, 1e-15);
  EXPECT_NEAR(areas(rest.solid)["slice.z-"], 0.03 * 0.07, 1e-14);
}

// Proves the same for shapes turned together, where no coordinate is exact.
TEST(TriangleBooleans, FacesMayCoincideHoweverTurned) {
  for (int pose = 0; pose < 15; ++pose) {
    const Mat3 turn = Eigen::AngleAxisd(0.4 * pose + 0.1, Vec3(1, 2, 0.1 * pose).normalized()).toRotationMatrix();
    const Vec3 shift(0.3, -2, 0.1 * pose);
    const Solid top = Solid::box({0, 0, 1}, {1.3, 1, 2}, "top").transformed(turn, shift);
    const auto joined = combine_triangles(BooleanOp::Kind::unite, cube().transformed(turn, shift), top, cell_size);
    EXPECT_NEAR(volume(joined.solid), 2.3, 1e-13);
    auto area = areas(joined.solid);
    EXPECT_NEAR(area["part.rest"], 5, 1e-12);
    EXPECT_NEAR(area["top.z-"], 0.3, 1e-12);
  }
}

// Proves that any expression of shapes is an operand, on either side, and two meshes are operands as well.
TEST(TriangleBooleans, ExpressionsAndMeshesAreOperands) {
  const Solid plate = Solid::box({-1, -1, 0.4}, {2, 2, 0.6}, "plate");
  const Solid hole = Solid::box({0.25, 0.25, 0}, {0.75, 0.75, 1}, "hole");
  const auto slot = combine_triangles(BooleanOp::Kind::subtract, Solid::subtract(plate, hole), cube(), cell_size);
  EXPECT_NEAR(volume(slot.solid), (9 - 1) * 0.2, 1e-13);  // the hole lies inside the cube
  const auto frame = combine_triangles(BooleanOp::Kind::intersect, cube(), Solid::subtract(plate, hole), cell_size);
  EXPECT_NEAR(volume(frame.solid), (1 - 0.25) * 0.2, 1e-14);
  const auto lens = combine_triangles(BooleanOp::Kind::intersect, cube(), cube({0.5, 0.5, 0.5}, {2, 2, 2}), cell_size);
  EXPECT_NEAR(volume(lens.solid), 0.125, 1e-15);
}

// Proves that what bounds no body is refused, and says why.
TEST(TriangleBooleans, WhatBoundsNoBodyIsRefused) {
  const auto far = Solid::box({3, 3, 3}, {4, 4, 4}, "far");
  EXPECT_NE(error_of(BooleanOp::Kind::intersect, cube(), far).find("empty"), std::string::npos);
  const auto beside = Solid::box({1, 1, 0}, {2, 2, 1}, "beside");  // an edge in common
  EXPECT_NE(error_of(BooleanOp::Kind::unite, cube(), beside).find("touch along an edge"), std::string::npos);
  const auto below = Solid::half_space({0, 0, 0.5}, {0, 0, 1}, "below");
  EXPECT_NE(error_of(BooleanOp::Kind::unite, cube(), below).find("unbounded"), std::string::npos);
}

}  // namespace
}  // namespace cgcontact::test_triangle_booleans
