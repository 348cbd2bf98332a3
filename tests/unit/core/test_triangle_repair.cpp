// Repair of surfaces that bound no body: what comes out bounds the body that was meant, and what changed is told.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/errors/errors.hpp"
#include "core/triangles/triangle_checks.hpp"
#include "core/triangles/triangle_repair.hpp"
#include "tests/support/triangle_shapes.hpp"

namespace cgcontact::test_triangle_repair {
namespace {

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

TriangleSoup cube() { return test::box_soup({0, 0, 0}, {1, 1, 1}); }

/// Repaired, checked; its volume is the expected one up to rounding.
SurfaceRepair repaired(TriangleSoup soup, double volume) {
  EXPECT_THROW(
      {
        TriangleSoup copy = soup;
        repair_and_check(copy, "part.stl");
      },
      InputError);
  const SurfaceRepair repair = repair_surface(soup, "part.stl");
  EXPECT_EQ(repair.is_new.size(), soup.triangles.size());
  EXPECT_NO_THROW(check_separated(soup, "part.stl"));
  EXPECT_NEAR(repair.volume_after, volume, 1e-9 * volume);
  return repair;
}

// Proves that open surfaces are closed: a triangle, a face, the faces at a corner missing; flat holes give the body
// back, and the new triangles are as far from the old surface as the hole is wide.
TEST(TriangleRepair, HolesAreFilled) {
  TriangleSoup open = cube();
  open.triangles.pop_back();
  const SurfaceRepair one = repaired(open, 1);
  EXPECT_EQ(one.holes, 1);
  EXPECT_EQ(one.new_triangles, 1);
  EXPECT_EQ(one.gone_triangles, 0);
  EXPECT_NEAR(one.distance, std::sqrt(2.0) / 6, 1e-12);  // the centroid from the diagonal
  open.triangles.pop_back();
  EXPECT_NEAR(repaired(open, 1).area_before, 5, 1e-12);
  TriangleSoup ball = test::sphere_soup(1, 12);
  const std::size_t all = ball.triangles.size();
  double before = 0;
  for (const Triangle& t : ball.triangles)
    before += ball.points[t[0]].dot(ball.points[t[1]].cross(ball.points[t[2]])) / 6;
  ball.triangles.erase(ball.triangles.begin() + static_cast<std::ptrdiff_t>(all / 2));
  ball.triangles.erase(ball.triangles.begin() + 3);
  const SurfaceRepair two = repaired(ball, before);
  EXPECT_EQ(two.holes, 2);
}

// Proves that rims with a gap are joined, and that single triangles are turned over.
TEST(TriangleRepair, GapsAndTurnedTriangles) {
  TriangleSoup gap = cube();
  gap.points.push_back(gap.points[7] + Vec3(3e-5, 0, 2e-5));
  gap.triangles[3][1] = 8;  // one of its corners is beside the others
  const SurfaceRepair closed = repair_surface(gap, "part.stl");
  EXPECT_EQ(closed.merged_points, 1);
  EXPECT_NEAR(closed.volume_after, 1, 1e-4);
  TriangleSoup turned = cube();
  std::swap(turned.triangles[5][0], turned.triangles[5][1]);
  EXPECT_EQ(repaired(turned, 1).turned, 1);
}

// Proves that overlapping shells become their union, also with faces in one plane, one inside the other, and crosswise;
// that a cavity stays one; that bodies apart stay as they are.
TEST(TriangleRepair, OverlappingShellsAreUnited) {
  const SurfaceRepair shifted =
      repaired(joined(cube(), test::box_soup({0.5, 0.25, 0.3}, {1.7, 0.75, 0.6})), 1 + 0.7 * 0.15);
  EXPECT_EQ(shifted.united, 1);
  repaired(joined(cube(), test::box_soup({0.5, 0, 0}, {1.5, 1, 1})), 1.5);
  repaired(joined(cube(), test::box_soup({1, 0.25, 0.25}, {2, 0.75, 0.75})), 1.25);
  repaired(joined(joined(cube(), test::box_soup({-1, 0.2, 0.2}, {2, 0.4, 0.4})),
                  test::box_soup({0.1, -1, 0.3}, {0.3, 2, 0.7})),
           1 + 2 * 0.04 + 2 * 0.08);
  const TriangleSoup hollow = joined(cube(), inside_out(test::box_soup({0.2, 0.2, 0.2}, {0.4, 0.4, 0.4})));
  repaired(joined(hollow, test::box_soup({0.8, 0.8, 0.8}, {1.2, 1.2, 1.2})), 1 - 0.008 + 0.064 - 0.008);
  repaired(
      joined(joined(cube(), test::box_soup({0.5, 0.5, 0.5}, {1.5, 1.5, 1.5})), test::box_soup({5, 0, 0}, {6, 1, 1})),
      2.875);
}

// Proves that shells inside out, bodies that touch along an edge only, walls inside a body and sheets of no thickness
// come out as bodies.
TEST(TriangleRepair, ShellsThatAreNotManifold) {
  repaired(joined(cube(), inside_out(test::box_soup({3, 0, 0}, {4, 1, 1}))), 2);
  const SurfaceRepair edge = repaired(joined(cube(), test::box_soup({1, 1, 0}, {2, 2, 1})), 2);
  EXPECT_EQ(edge.new_triangles, 0);
  TriangleSoup wall = joined(cube(), test::box_soup({1, 0, 0}, {2, 1, 1}));  // the common face is there twice
  repaired(wall, 2);
  TriangleSoup sheet = joined(cube(), test::box_soup({3, 0, 0}, {4, 1, 1}));
  sheet.triangles.resize(12 + 2);
  EXPECT_EQ(repaired(sheet, 1).lost, 1);
}

// Proves that a shell that crosses itself (two boxes that pass through each other, joined by a bridge of triangles into
// one shell) is cut along the crossing.
TEST(TriangleRepair, ShellThatCrossesItself) {
  TriangleSoup soup = test::torus_soup(2, 0.5, 24);
  for (Vec3& x : soup.points)
    if (x[0] > 2.4) x[0] = -2.2;  // a dent through the opposite side
  EXPECT_THROW(
      {
        TriangleSoup copy = soup;
        repair_and_check(copy, "part.stl");
      },
      InputError);
  try {
    const SurfaceRepair repair = repair_surface(soup, "part.stl");
    EXPECT_EQ(repair.untangled, 1);
    EXPECT_GT(repair.volume_after, 0);
    EXPECT_NO_THROW(check_separated(soup, "part.stl"));
  } catch (const InputError& error) {  // refused clearly is the other right answer
    EXPECT_NE(std::string(error.what()).find("repair = true does not help"), std::string::npos) << error.what();
  }
}

// Proves that the union of four boxes that cross at many edges is exact, also where no face is along an axis.
TEST(TriangleRepair, CrossingsAreCutExactly) {
  const Eigen::AngleAxisd turn(0.7, Vec3(1, 2, 3).normalized());
  for (const bool turned : {false, true}) {
    TriangleSoup soup = cube();
    for (const double shift : {0.5, 0.25, -0.75}) {
      const Vec3 at(shift, 0.3 * shift, -0.4 * shift);
      soup = joined(soup, test::box_soup(at, at + Vec3::Ones()));
    }
    double grid_volume = 0;  // of the union, by planes between all sides
    const std::vector<double> shifts = {0, 0.5, 0.25, -0.75};
    std::vector<double> cuts[3];
    for (const double s : shifts)
      for (int k = 0; k < 3; ++k)
        for (const double end : {0.0, 1.0}) cuts[k].push_back(Vec3(s, 0.3 * s, -0.4 * s)[k] + end);
    for (auto& c : cuts) std::sort(c.begin(), c.end());
    for (std::size_t i = 1; i < 8; ++i)
      for (std::size_t j = 1; j < 8; ++j)
        for (std::size_t k = 1; k < 8; ++k) {
          const Vec3 low(cuts[0][i - 1], cuts[1][j - 1], cuts[2][k - 1]), high(cuts[0][i], cuts[1][j], cuts[2][k]);
          const Vec3 x = (low + high) / 2;
          const bool inside = std::any_of(shifts.begin(), shifts.end(), [&](double s) {
            const Vec3 local = x - Vec3(s, 0.3 * s, -0.4 * s);
            return local.minCoeff() > 0 && local.maxCoeff() < 1;
          });
          if (inside) grid_volume += (high - low).prod();
        }
    if (turned)
      for (Vec3& x : soup.points) x = turn * x;
    EXPECT_EQ(repaired(soup, grid_volume).united, 3);
  }
}

// Proves that what has no inside is refused with one error.
TEST(TriangleRepair, NothingToRepair) {
  TriangleSoup sheet = cube();
  sheet.triangles.resize(2);
  try {
    repair_surface(sheet, "part.stl");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("part.stl: repair = true does not help: it encloses no volume"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace cgcontact::test_triangle_repair
