// Named faces of triangle surfaces, patches, and searches on the surface.
#include <gtest/gtest.h>

#include <random>

#include "core/base/errors/errors.hpp"
#include "core/geometry/solid.hpp"
#include "tests/support/triangle_shapes.hpp"

namespace cgcontact::test_triangle_faces {
namespace {

TriangleSelector by_normal(const std::string& name, const Vec3& axis, double degrees) {
  TriangleSelector selector;
  selector.name = name;
  selector.normal_cone = std::make_pair(axis, std::cos(degrees * pi / 180));
  return selector;
}

TriangleSelector grown(const std::string& name, const Vec3& seed, double degrees) {
  TriangleSelector selector;
  selector.name = name;
  selector.smooth = {seed, degrees * pi / 180};
  return selector;
}

int count(const NamedTriangles& faces, const std::string& name) {
  int n = 0;
  for (int f : faces.face) n += faces.names[f] == name;
  return n;
}

std::string message_of(const TriangleSoup& soup, const std::vector<TriangleSelector>& selectors) {
  try {
    name_faces(soup, "part", selectors);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Proves what each selector takes, alone and combined, and that the rest is a face of its own.
TEST(TriangleFaces, SelectorsTakeWhatTheySay) {
  const TriangleSoup cylinder = test::prism_soup(test::star(36, 2, 2), {0, 0}, 3);  // 36 of 10 degrees
  const NamedTriangles plain = name_faces(cylinder, "part", {});
  EXPECT_EQ(plain.names, std::vector<std::string>{"part.rest"});

  const NamedTriangles faces =
      name_faces(cylinder, "part", {by_normal("top", {0, 0, 1}, 1), grown("side", {2, 0, 1}, 15)});
  EXPECT_EQ(count(faces, "part.top"), 36);
  EXPECT_EQ(count(faces, "part.side"), 72);
  EXPECT_EQ(count(faces, "part.rest"), 36);

  TriangleSelector plane;
  plane.name = "bottom";
  plane.plane = {Vec3(7, 8, 0), Vec3(0, 0, 1), 1e-9};
  EXPECT_EQ(count(name_faces(cylinder, "part", {plane}), "part.bottom"), 36);

  TriangleSelector box;
  box.name = "right";
  box.box = std::make_pair(Vec3(0, -9, -9), Vec3(9, 9, 9));
  EXPECT_EQ(count(name_faces(cylinder, "part", {box}), "part.right"), 18 * 4);
  TriangleSelector both = grown("right", {2, 0.1, 1}, 15);
  both.box = box.box;
  EXPECT_EQ(count(name_faces(cylinder, "part", {both}), "part.right"), 18 * 2);
}

// Proves that a selection that is empty, or has triangles of another, is refused by name.
TEST(TriangleFaces, EmptyAndOverlappingSelectionsAreRefused) {
  const TriangleSoup cube = test::box_soup({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(message_of(cube, {by_normal("slope", {0.6, 0.8, 0}, 20)}),
            "\"slope\": the face selects no triangle (allowed: triangles that meet all selectors given)");
  EXPECT_NE(message_of(cube, {by_normal("top", {0, 0, 1}, 1), by_normal("upper", {0, 0, 1}, 30)})
                .find("\"upper\": overlaps the face \"top\": both select triangle 11 at"),
            std::string::npos);
}

// Proves that creases divide faces into patches, that flat ones become planes with the face's name, and curved ones do
// not.
TEST(TriangleFaces, PatchesAreTheSurfacesOfTheSolid) {
  const TriangleSoup cylinder = test::prism_soup(test::star(36, 2, 2), {0, 0}, 3);
  const Solid solid = Solid::bounded_by(
      make_surface(cylinder, name_faces(cylinder, "part", {by_normal("top", {0, 0, 1}, 1)}), default_crease_angle));
  ASSERT_EQ(solid.surfaces().size(), 3u);
  int planes = 0, top = 0;
  for (const Surface& s : solid.surfaces()) {
    planes += s.kind == Surface::Kind::plane;
    top += s.names == std::vector<std::string>{"part.top"};
  }
  EXPECT_EQ(planes, 2);
  EXPECT_EQ(top, 1);
  const int side = solid.surface_at({2, 0, 1}, {1, 0, 0});
  EXPECT_EQ(solid.surfaces()[side].kind, Surface::Kind::patch);
  // To the plane of the nearest facet, whose distance from the axis is 2 cos(5 degrees).
  EXPECT_NEAR(solid.surfaces()[side].signed_distance(Eigen::AngleAxisd(pi / 36, Vec3::UnitZ()) * Vec3(2.5, 0, 1)),
              2.5 - 2 * std::cos(pi / 36), 1e-14);
  EXPECT_EQ(solid.surface_at({0.1, 0.2, 3}, {0, 0, 1}), solid.surface_at({2, 0, 3}, {0, 0, 1}));
}

// Proves inside and outside against the exact shape, also for points on edges' and corners' side.
TEST(TriangleSurface, ContainsIsRightEverywhere) {
  const TriangleSurface block =
      test::surface_of(test::prism_soup({{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}}, {0.5, 0.5}, 2));
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-0.5, 4.5);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 x(uniform(generator), uniform(generator), uniform(generator));
    const bool inside = x.minCoeff() > 0 && x[2] < 2 && ((x[0] < 4 && x[1] < 1) || (x[0] < 1 && x[1] < 3));
    EXPECT_EQ(block.contains(x), inside) << x.transpose();
  }
}

// Proves that lines through faces, edges and corners find the boundary.
TEST(TriangleSurface, LinesFindTheBoundary) {
  const TriangleSurface cube = test::surface_of(test::box_soup({0, 0, 0}, {1, 1, 1}));
  for (const double y : {0.3, 0.5, 1.0})
    for (const double z : {0.2, 0.5, 1.0}) {
      double first = 1e9, last = -1e9;
      cube.each_hit({-2, y, z}, {1, 0, 0}, 10, [&](double t, int) {
        first = std::min(first, t);
        last = std::max(last, t);
      });
      EXPECT_DOUBLE_EQ(first, 2) << y << " " << z;
      EXPECT_DOUBLE_EQ(last, 3) << y << " " << z;
    }
  int hits = 0;
  cube.each_hit({-2, 0.3, 0.2}, {1, 0, 0}, 1.9, [&](double, int) { ++hits; });
  EXPECT_EQ(hits, 0) << "beyond the reach";
}

}  // namespace
}  // namespace cgcontact::test_triangle_faces
