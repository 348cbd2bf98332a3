// Proves that the interface of bodies suffices: an ellipsoid, which only the tests know, goes through the same code as
// the kinds of the program.
#include "core/bodies/csg_body.hpp"
#include "core/bodies/triangle_body.hpp"
#include "core/drawing/clip_cells.hpp"
#include "tests/support/ellipsoid.hpp"
#include "tests/support/triangle_shapes.hpp"
#include "tests/unit/core/cut_cells_checks.hpp"

namespace cgcontact::test_body_geometry {
namespace {

using test::ellipsoid;

const Vec3 semi_axes(4.3, 3.1, 2.2);  // cells
const double volume = 4 * pi / 3 * semi_axes.prod();

/// Area of an ellipsoid by a rule over the angles of the unit sphere.
double area_of(const Vec3& a) {
  const GaussRule& rule = gauss_rule(32);
  double sum = 0;
  for (std::size_t i = 0; i < rule.node.size(); ++i)
    for (int j = 0; j < 400; ++j) {
      const double z = 2 * rule.node[i] - 1, r = std::sqrt(1 - z * z), angle = 2 * pi * j / 400;
      const Vec3 y(r * std::cos(angle), r * std::sin(angle), z);
      sum += 2 * rule.weight[i] * 2 * pi / 400 * a.prod() * y.cwiseQuotient(a).norm();
    }
  return sum;
}

CutCells turned_cells() {
  return cut(ellipsoid({0, 0, 0}, semi_axes, rotation({1, 2, -1}, 0.7), "egg"), rotation({3, 1, 2}, 0.4),
             {0.31, 0.17, 0.43});
}

// Volume, area, and the divergence theorem between them, to what the lines of the example integrate.
TEST(BodyGeometry, AThirdKindGoesThroughCutCells) {
  const CutCells cells = turned_cells();
  check_structure(cells);
  const Totals sum = totals(cells);
  EXPECT_NEAR(sum.volume, volume, 1e-4 * volume);
  EXPECT_NEAR(sum.flux, volume, 3e-4 * volume);
  EXPECT_NEAR(sum.area, area_of(semi_axes), 3e-5 * area_of(semi_axes));
  EXPECT_LT(sum.closure.norm(), 2e-4 * sum.area);
  EXPECT_NEAR(area_by_cells(cells, {}, 2), sum.area, 1e-12 * sum.area);
  EXPECT_GT(cells.cells.size(), cells.moments.size()) << "some cells are inside";
}

// The same numbers as of a body of the program, point by point of the interface.
TEST(BodyGeometry, ABallOfTheThirdKindIsTheBallOfTheFirst) {
  const Vec3 centre(0.3, -0.2, 0.5);
  const Solid egg = ellipsoid(centre, Vec3::Constant(3.3), rotation({1, 1, 0}, 0.3), "ball.surface"),
              ball = Solid::sphere(centre, 3.3, "ball");
  Vec3 min, max, ball_min, ball_max;
  ASSERT_TRUE(egg.bounding_box(min, max) && ball.bounding_box(ball_min, ball_max));
  EXPECT_LT((min - ball_min).norm() + (max - ball_max).norm(), 1e-14);
  for (const Vec3& x : {Vec3(2, 1, 0.4), Vec3(-3, 2, 1), Vec3(0.31, -0.2, 0.5), Vec3(5, 5, 5), Vec3(-0.7, 0.2, -2.4)}) {
    EXPECT_EQ(egg.contains(x), ball.contains(x));
    EXPECT_NEAR(egg.distance_to_surfaces(x), ball.distance_to_surfaces(x), 1e-10);
    EXPECT_NEAR(egg.surfaces()[0].signed_distance(x), ball.surfaces()[0].signed_distance(x), 1e-10);
    EXPECT_NEAR(egg.surfaces()[0].gradient(x).dot(ball.surfaces()[0].gradient(x)), 1, 1e-10);
    std::vector<Crossing> found, expected;
    egg.crossings(x, Vec3(1, 2, 2) / 3, 20, found);
    ball.crossings(x, Vec3(1, 2, 2) / 3, 20, expected);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_NEAR(found[i].t, expected[i].t, 1e-12);
      EXPECT_NEAR(found[i].normal.dot(expected[i].normal), 1, 1e-12);
    }
  }
  Grid grid;
  grid.cell_size = 0.1;
  grid.num_cells = {80, 80, 80};
  grid.origin = Vec3::Constant(-4.1);
  const CellEstimate a = egg.geometry().estimate_cells(grid, 1 << 17),
                     b = ball.geometry().estimate_cells(grid, 1 << 17);
  EXPECT_NEAR(a.nodes, b.nodes, 0.1 * b.nodes);
  EXPECT_NEAR(a.cut_cells, b.cut_cells, 0.1 * b.cut_cells);
}

// A body that sticks out of its grid is estimated by what is inside, whole coarse cells or fractions of them; the cells
// that are made afterwards refuse it.
TEST(BodyGeometry, AnEstimateOfABodyThatSticksOut) {
  Grid grid;
  grid.num_cells = {12, 12, 12};
  grid.origin = Vec3::Zero();
  const auto box = [](double end) { return Solid::box({2.4, 2.4, 2.4}, {end, 9.6, 9.6}, "box"); };
  for (const double max_cells : {1e6, 500.0}) {  // cells as they are, two in one
    const CellEstimate inside = box(12).geometry().estimate_cells(grid, max_cells),
                       out = box(12.7).geometry().estimate_cells(grid, max_cells);
    EXPECT_GT(inside.nodes, 9.6 * 7.2 * 7.2);
    EXPECT_GT(inside.cut_cells, 2 * 7 * 8);
    EXPECT_NEAR(out.nodes, inside.nodes, 0.15 * inside.nodes);
    EXPECT_NEAR(out.cut_cells, inside.cut_cells, 0.15 * inside.cut_cells);
  }
  EXPECT_THROW(make_cut_cells(box(12.7), grid), InputError);
}

// Drawn without facets of its own, by chords of half a cell: 1.5 % too small where the radius is a cell.
TEST(BodyGeometry, AThirdKindIsDrawn) {
  const CutCells cells = turned_cells();
  const ClippedMesh mesh = clip_cells(cells);
  EXPECT_NEAR(mesh.volume(), volume, 0.02 * volume);
  EXPECT_NEAR(mesh.boundary_area(), area_of(semi_axes), 0.02 * area_of(semi_axes));
  for (const BoundaryTriangle& triangle : mesh.boundary) EXPECT_EQ(triangle.surface, 0);
}

// Which kind a body is, is a question of this folder alone; where it is asked, each kind is known as itself.
TEST(BodyGeometry, KindsAreToldApart) {
  const Solid egg = ellipsoid({0, 0, 0}, semi_axes, Mat3::Identity(), "egg"), ball = Solid::sphere({0, 0, 0}, 1, "s");
  EXPECT_FALSE(as_csg(egg) || as_triangles(egg) || as_triangles(ball));
  EXPECT_TRUE(as_csg(ball));
  EXPECT_THROW(Solid::unite(egg, ball), InputError);
  EXPECT_EQ(Solid().surfaces().size(), 0u);
  EXPECT_FALSE(Solid().contains({0, 0, 0}));
}

}  // namespace
}  // namespace cgcontact::test_body_geometry
