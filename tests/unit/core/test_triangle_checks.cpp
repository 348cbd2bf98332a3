// Defects of triangle surfaces: small ones are repaired and counted, others are refused with what and where.
#include <gtest/gtest.h>

#include "core/base/errors/errors.hpp"
#include "core/triangles/triangle_checks.hpp"
#include "core/triangles/triangle_crossings.hpp"
#include "tests/support/triangle_shapes.hpp"

namespace cgcontact::test_triangle_checks {
namespace {

std::string message_of(TriangleSoup soup) {
  try {
    repair_and_check(soup, "part.stl");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_message(const TriangleSoup& soup, const std::vector<std::string>& words) {
  const std::string message = message_of(soup);
  for (const std::string& word : words)
    EXPECT_NE(message.find(word), std::string::npos) << word << "\n  in: " << message;
}

double volume_of(const TriangleSoup& soup) {
  double volume = 0;
  for (const Triangle& t : soup.triangles)
    volume += soup.points[t[0]].dot(soup.points[t[1]].cross(soup.points[t[2]])) / 6;
  return volume;
}

TriangleSoup cube() { return test::box_soup({0, 0, 0}, {1, 1, 1}); }

TriangleSoup joined(TriangleSoup a, const TriangleSoup& b) {
  const int first = static_cast<int>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

TriangleSoup inside_out(TriangleSoup soup) {
  for (Triangle& t : soup.triangles) std::swap(t[0], t[1]);
  return soup;
}

// Proves that sound surfaces pass unchanged: ten shapes, a cavity, two bodies apart.
TEST(TriangleChecks, SoundSurfacesPass) {
  for (const test::NamedSoup& shape : test::ten_shapes()) {
    TriangleSoup soup = shape.soup;
    const SurfaceRepairs repairs = repair_and_check(soup, "part.stl");
    EXPECT_FALSE(repairs.any()) << shape.name;
    EXPECT_EQ(repairs.shells, 1) << shape.name;
    EXPECT_EQ(soup.triangles, shape.soup.triangles) << shape.name;
  }
  TriangleSoup hollow = joined(cube(), inside_out(test::box_soup({0.2, 0.2, 0.2}, {0.7, 0.8, 0.9})));
  EXPECT_EQ(repair_and_check(hollow, "part.stl").shells, 2);
  TriangleSoup two = joined(cube(), test::box_soup({2, 0, 0}, {3, 1, 1}));
  EXPECT_EQ(repair_and_check(two, "part.stl").shells, 2);
}

// Proves that defects with one obvious repair are repaired and counted.
TEST(TriangleChecks, SmallDefectsAreRepaired) {
  TriangleSoup turned = inside_out(cube());
  EXPECT_EQ(repair_and_check(turned, "part.stl").text(), "surface turned outwards");
  EXPECT_DOUBLE_EQ(volume_of(turned), 1);

  TriangleSoup doubled = cube();  // a corner is there twice, once with an error of single precision
  doubled.points.push_back(doubled.points[7]);
  doubled.points.push_back(doubled.points[0] + Vec3(1e-7, 0, 0));
  doubled.triangles[3][1] = 8;
  doubled.triangles[8][0] = 9;
  EXPECT_EQ(repair_and_check(doubled, "part.stl").text(), "2 duplicate points merged");
  EXPECT_DOUBLE_EQ(volume_of(doubled), 1);

  TriangleSoup repeated = cube();
  repeated.triangles.push_back({4, 6, 0});
  repeated.triangles.push_back({1, 1, 3});
  EXPECT_EQ(repair_and_check(repeated, "part.stl").text(),
            "1 triangle without area removed, 1 duplicate triangle removed");
  EXPECT_EQ(repeated.triangles.size(), 12u);

  TriangleSoup needle = cube();  // the edge 1-3 has a point in the middle on one side, and a needle closes the gap
  needle.points.push_back(0.5 * (needle.points[1] + needle.points[3]));
  needle.triangles[2] = {1, 8, 7};
  needle.triangles.push_back({8, 3, 7});
  needle.triangles.push_back({1, 3, 8});
  EXPECT_EQ(repair_and_check(needle, "part.stl").text(), "1 triangle without area removed");
  EXPECT_DOUBLE_EQ(volume_of(needle), 1);
  EXPECT_EQ(needle.triangles.size(), 14u);
}

// Proves that everything else is refused, with the kind of defect and its location.
TEST(TriangleChecks, OtherDefectsAreRefused) {
  TriangleSoup open = cube();
  open.triangles.pop_back();
  expect_message(open,
                 {"part.stl: the surface is not closed: 3 open edges", "from (0, 0, 1) to (0, 1, 1), triangle 1 at"});

  TriangleSoup crowded = joined(cube(), cube());  // two cubes with a common edge
  for (std::size_t p = 8; p < 16; ++p) crowded.points[p] += Vec3(1, 1, 0);
  expect_message(crowded, {"1 edge belongs to more than two triangles", "from (1, 1, "});

  TriangleSoup mixed = cube();
  std::swap(mixed.triangles[5][0], mixed.triangles[5][1]);
  expect_message(mixed, {"neighbouring triangles disagree about which side is outside at 3 edges", "triangle 6 at"});

  expect_message(joined(cube(), test::box_soup({0.2, 0.2, 0.2}, {0.7, 0.8, 0.9})),
                 {"1 of 2 shells is inside out: the one with triangle 13 at"});
  expect_message(joined(cube(), test::box_soup({0.5, 0.5, 0.5}, {2, 2, 2})),
                 {"the surface crosses itself", "triangle"});
  expect_message(joined(cube(), test::box_soup({0.3, 0.4, 0.5}, {2, 0.6, 0.7})), {"the surface crosses itself: "});

  TriangleSoup bad = cube();
  bad.points[3][1] = std::nan("");
  expect_message(bad, {"point 4 is not finite"});
  expect_message({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 1}}, {}, {}}, {"no triangle has an area"});
}

// Proves that triangles that touch along edges and corners, or lie near each other, do not count as crossing.
TEST(TriangleChecks, TouchingIsNotCrossing) {
  const TriangleSoup apart = joined(cube(), test::box_soup({1 + 1e-9, 0, 0}, {2, 1, 1}));
  EXPECT_TRUE(find_crossings(apart.points, apart.triangles).empty());
  const TriangleSoup touching = joined(cube(), test::box_soup({1, 0.25, 0.25}, {2, 0.75, 0.75}));
  EXPECT_TRUE(find_crossings(touching.points, touching.triangles).empty());
}

}  // namespace
}  // namespace cgcontact::test_triangle_checks
