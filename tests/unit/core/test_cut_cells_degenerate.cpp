// Degenerate positions: faces on grid planes, edges on grid edges, up to rounding. Every volume and every facet of
// surface must be counted once.
#include "tests/unit/core/cut_cells_checks.hpp"

namespace cgcontact::test_cut_cells_degenerate {
namespace {

std::vector<double> offsets() {
  std::vector<double> list{0};
  for (int e = -17; e <= -1; ++e)
    for (double factor : {1.0, -1.0, 3.7}) list.push_back(factor * std::pow(10.0, e));
  return list;
}

Grid cube_grid(int n) {
  Grid grid;
  grid.num_cells = {n, n, n};
  return grid;
}

/// Totals from the default points and from points asked for cell by cell with dividers.
void expect_exact(const Solid& solid, const Grid& grid, double volume, double area, double tolerance) {
  const CutCells cells = make_cut_cells(solid, grid);
  check_structure(cells);
  const Totals sum = totals(cells);
  EXPECT_NEAR(sum.volume / volume, 1, tolerance);
  EXPECT_NEAR(sum.area / area, 1, tolerance);
  EXPECT_NEAR(sum.flux / volume, 1, tolerance);
  EXPECT_LT(sum.closure.norm() / area, tolerance);
  const std::vector<Plane> dividers{{Vec3(1, 2, 3).normalized(), 5.7}, {Vec3(1, 0, 0), 3}, {Vec3(0, 0, 1), 3 + 1e-15}};
  EXPECT_NEAR(area_by_cells(cells, dividers, 2) / area, 1, tolerance < 1e-9 ? tolerance : 1e-7);
}

// Proves exactness of boxes for every offset of their faces from grid planes. 1e-13: rounding of the sums.
TEST(DegenerateCells, BoxesAtAllOffsets) {
  for (const double o : offsets()) {
    SCOPED_TRACE(o);
    const Vec3 shift = Vec3::Constant(o);
    expect_exact(Solid::box(Vec3(1, 2, 3) + shift, Vec3(4, 4, 5) + shift, "b"), cube_grid(6), 12, 32, 1e-13);
    const double x = 3 - 2 * o, y = 2 + 2 * o, z = 2;
    expect_exact(Solid::box(Vec3(1 + o, 2 - o, 3), Vec3(4 - o, 4 + o, 5), "b"), cube_grid(6), x * y * z,
                 2 * (x * y + y * z + z * x), 1e-13);
  }
}

// Proves the same for rotations of 1e-16 .. 1 about odd axes and pivots that keep edges or corners on grid nodes.
TEST(DegenerateCells, BoxesAtAllRotations) {
  const Vec3 axes[] = {{1, 0, 0}, {0, 0, 1}, {1, 1, 0}, {1, 2, 3}, {-3, 1, 0.2}};
  const Vec3 pivots[] = {{0, 0, 0}, {2, 2, 1}, {2.3, 0.4, 1.7}};
  for (int e = -16; e <= 0; ++e)
    for (const Vec3& axis : axes)
      for (const Vec3& pivot : pivots) {
        SCOPED_TRACE(e);
        const Mat3 turn = rotation(axis, std::pow(10.0, e));
        const Vec3 shift = Vec3::Constant(5) + pivot - turn * pivot;
        expect_exact(Solid::box({-2, -1, -1}, {2, 2, 1}, "b").transformed(turn, shift), cube_grid(11), 24, 52, 1e-13);
      }
}

// Proves that faces on grid planes give full cells that own their points, not slivers or empty cells.
TEST(DegenerateCells, FacesOnGridPlanesGiveFullCells) {
  for (const double o : {0.0, 1e-17, -1e-16, 1e-15, -1e-14, 5e-14}) {
    SCOPED_TRACE(o);
    Grid grid = cube_grid(6);
    const Solid box =
        Solid::box({1, 1, 1}, {4, 4, 4}, "b").transformed(rotation({1, 1, 1}, 0.1 * o), Vec3::Constant(o));
    const CutCells cells = make_cut_cells(box, grid);
    ASSERT_EQ(cells.cells.size(), 27u);
    EXPECT_EQ(cells.moments.size(), 26u) << "only the cell in the middle has no boundary";
    for (int a = 0; a < 27; ++a) EXPECT_NEAR(cells.volume_fraction(a), 1, 3e-13);
    for (std::size_t i = 0; i < cells.boundary.size(); ++i) {
      const Index3& c = cells.cells[cells.boundary.cell[i]];
      const Vec3 inside = cells.boundary.position[i] - 0.5 * cells.boundary.normal[i];
      for (int k = 0; k < 3; ++k) {  // strips of width 1e-14 beyond an edge belong to the cell at the edge
        EXPECT_GT(inside[k], c[k] - 1e-12);
        EXPECT_LT(inside[k], c[k] + 1 + 1e-12);
      }
    }
  }
}

// Proves that a body that fills its grid up to rounding loses nothing at the grid's boundary.
TEST(DegenerateCells, BodiesThatFillTheirGrid) {
  Grid grid;
  grid.num_cells = {4, 4, 5};
  for (const double o : {0.0, 1e-17, -1e-16, 2e-15, -3e-14, 1e-13, -1e-13}) {
    SCOPED_TRACE(o);
    const Solid box = Solid::box({0, 0, 0}, {4, 4, 5}, "b").transformed(rotation({1, 2, 3}, o), Vec3::Constant(o));
    expect_exact(box, grid, 80, 112, 1e-13);
  }
}

// Proves the same for unions and differences with common faces and re-entrant edges on grid edges.
TEST(DegenerateCells, BooleansWithCommonFaces) {
  const Solid hole = Solid::subtract(Solid::box({0, 0, 0}, {3, 3, 3}, "a"), Solid::box({1, 1, 0}, {2, 2, 3}, "b"));
  const Solid angle = Solid::unite(Solid::box({0, 0, 0}, {3, 1, 2}, "a"), Solid::box({0, 1, 0}, {1, 3, 2}, "b"));
  const Solid stack = Solid::unite(Solid::box({0, 0, 0}, {3, 3, 1}, "a"), Solid::box({1, 1, 1}, {2, 2, 2}, "b"));
  for (const double o : offsets())
    for (const double angle_of_turn : {0.0, 1e-16, 1e-13, 1e-10, 1e-5, 0.3}) {
      SCOPED_TRACE(o);
      SCOPED_TRACE(angle_of_turn);
      const Mat3 turn = rotation({1, 2, 3}, angle_of_turn);
      const Vec3 shift(3 + o, 3 - o, 3 + 0.5 * o);
      expect_exact(hole.transformed(turn, shift), cube_grid(9), 24, 64, 1e-13);
      expect_exact(angle.transformed(turn, shift), cube_grid(9), 10, 34, 1e-13);
      expect_exact(stack.transformed(turn, shift), cube_grid(9), 10, 34, 1e-13);
    }
}

// Proves that curved bodies that touch grid planes (a sphere in a point, a cylinder along a line) stay accurate; 1e-8
// is the accuracy promised for curved bodies.
TEST(DegenerateCells, CurvedBodiesTouchingGridPlanes) {
  const Solid ring =
      Solid::subtract(Solid::cylinder({0, 0, -2}, {0, 0, 2}, 4, "o"), Solid::cylinder({0, 0, -2}, {0, 0, 2}, 2, "i"));
  for (const double o : {0.0, 1e-17, 1e-16, -1e-15, 1e-14, -1e-12, 1e-10, 1e-8, -1e-6, 1e-4, 1e-2})
    for (const double angle : {0.0, 1e-16, 1e-12, 1e-8, 1e-4}) {
      SCOPED_TRACE(o);
      SCOPED_TRACE(angle);
      const Mat3 turn = rotation({1, 2, 3}, angle);
      const Vec3 shift = Vec3::Constant(6) + o * Vec3(1, -1, 0.5);
      expect_exact(Solid::sphere({0, 0, 0}, 4, "s").transformed(turn, shift), cube_grid(12), 256. / 3 * pi, 64 * pi,
                   1e-8);
      expect_exact(ring.transformed(turn, shift), cube_grid(12), 48 * pi, 72 * pi, 1e-8);
    }
}

// Proves that slivers keep their volume and points until they are rounding: a plate that ends 10^-k above a grid plane.
TEST(DegenerateCells, Slivers) {
  for (int e = -15; e <= -1; ++e) {
    SCOPED_TRACE(e);
    const double s = std::pow(10.0, e);
    const CutCells cells = make_cut_cells(Solid::box({1, 1, 1}, {4, 4, 3 + s}, "b"), cube_grid(5));
    check_structure(cells);
    const double thickness = (3 + s) - 3;  // as represented
    EXPECT_EQ(cells.find({2, 2, 3}) >= 0, thickness > 1e-12);
    if (thickness > 1e-12) {
      EXPECT_NEAR(cells.volume_fraction(cells.find({2, 2, 3})), thickness, 1e-15);
    }
    EXPECT_EQ(cells.num_pruned > 0, thickness > 0 && thickness < 1e-12);
    // the moments of a pruned sliver are in the cell below
    const int below = cells.find({2, 2, 2});
    EXPECT_NEAR(cells.volume_fraction(below), thickness < 1e-12 ? 1 + thickness : 1, 2e-15);
  }
  // a corner of (1e-6)^3 in a cell is below the threshold, its boundary facets of 1e-12 are not lost
  const double s = 1e-6;
  const Solid box = Solid::box({1, 1, 1}, {3 + s, 3 + s, 3 + s}, "b");
  expect_exact(box, cube_grid(5), std::pow(2 + s, 3), 6 * std::pow(2 + s, 2), 1e-13);
}

}  // namespace
}  // namespace cgcontact::test_cut_cells_degenerate
