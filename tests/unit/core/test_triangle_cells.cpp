// Cut cells of bodies bounded by triangle surfaces: exact in every position.
#include <random>

#include "core/bodies/triangle_body.hpp"
#include "tests/support/triangle_shapes.hpp"
#include "tests/unit/core/cut_cells_checks.hpp"

namespace cgcontact::test_triangle_cells {
namespace {

/// Integrals over the body by the divergence theorem, triangle by triangle.
struct SurfaceTotals {
  double volume = 0, area = 0;
  Vec3 first = Vec3::Zero();  ///< integral of x
};

SurfaceTotals surface_totals(const TriangleSurface& s) {
  SurfaceTotals sum;
  for (int t = 0; t < static_cast<int>(s.triangles().size()); ++t) {
    const Vec3 &a = s.corner(t, 0), &b = s.corner(t, 1), &c = s.corner(t, 2);
    const double volume = a.dot(b.cross(c)) / 6;
    sum.volume += volume;
    sum.first += volume * (a + b + c) / 4;
    sum.area += (b - a).cross(c - a).norm() / 2;
  }
  return sum;
}

void expect_exact(const CutCells& cells, double tolerance) {
  check_structure(cells);
  const SurfaceTotals exact = surface_totals(*as_triangles(cells.solid));
  const Totals sum = totals(cells);
  const double size = std::cbrt(exact.volume);
  EXPECT_NEAR(sum.volume / exact.volume, 1, tolerance);
  EXPECT_NEAR(sum.area / exact.area, 1, tolerance);
  EXPECT_NEAR(sum.flux / exact.volume, 1, tolerance);
  EXPECT_LT(sum.closure.norm() / exact.area, tolerance);
  EXPECT_LT((first_moment(cells) - exact.first).norm() / (exact.volume * size), 10 * tolerance);
  const std::vector<Plane> dividers{
      {Vec3(1, 2, 3).normalized(), 15.7}, {Vec3(1, 0, 0), 6}, {Vec3(0, 1, 0), 6}, {Vec3(0, 0, 1), 6 + 1e-15}};
  EXPECT_NEAR(area_by_cells(cells, dividers, 2) / exact.area, 1, tolerance);
}

Solid body(const TriangleSoup& soup) { return Solid::bounded_by(test::surface_of(soup)); }

// Proves exact volumes, areas and first moments of ten shapes in twenty random positions each. 1e-12: rounding of sums
// over some hundred cells, relative to the volume of the thinnest shape.
TEST(TriangleCells, TenShapesInRandomPositions) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const test::NamedSoup& shape : test::ten_shapes())
    for (int pose = 0; pose < 20; ++pose) {
      SCOPED_TRACE(shape.name + " " + std::to_string(pose));
      const Vec3 axis(uniform(generator) - 0.5, uniform(generator) - 0.5, uniform(generator) - 0.5);
      const Mat3 turn = rotation(axis, 6 * uniform(generator));
      const Vec3 fraction(uniform(generator), uniform(generator), uniform(generator));
      expect_exact(cut(body(shape.soup), turn, fraction), 1e-11);
    }
}

// Proves the same with faces, edges and corners on grid planes, up to shifts and turns of 1e-16 .. 1 rad about odd
// axes.
TEST(TriangleCells, DegeneratePositions) {
  for (const test::NamedSoup& shape : test::ten_shapes())
    for (const double angle : {0.0, 1e-16, 1e-12, 1e-8, 1e-3, 1.0})
      for (const double offset : {0.0, -7e-16, 4e-13, -1e-8})
        for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(1, 2, 3), Vec3(-3, 1, 0.2)}) {
          SCOPED_TRACE(shape.name + " " + std::to_string(std::log10(angle)) + " " + std::to_string(offset * 1e16));
          const Solid placed = body(shape.soup).transformed(rotation(axis, angle), Vec3::Constant(6 + offset));
          Grid grid;
          grid.num_cells = {13, 13, 13};
          expect_exact(make_cut_cells(placed, grid), 1e-11);
        }
}

// Proves the same for bodies of several shells, cavities and separate components, and for coordinates in single
// precision, which leave no face flat and no two triangles coplanar.
TEST(TriangleCells, ShellsAndSinglePrecision) {
  TriangleSoup shells = test::box_soup({0, 0, 0}, {4, 4, 4});
  const auto add = [&](TriangleSoup added, bool inward) {
    const int first = static_cast<int>(shells.points.size());
    shells.points.insert(shells.points.end(), added.points.begin(), added.points.end());
    for (Triangle t : added.triangles) {
      if (inward) std::swap(t[0], t[1]);
      shells.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  };
  add(test::box_soup({1, 1, 1}, {3, 3.5, 3}), true);
  add(test::box_soup({1.5, 1.5, 1.5}, {2, 2, 2}), false);
  add(test::box_soup({5, 0, 0}, {6, 4, 4}), false);
  for (const double angle : {0.0, 1e-12, 0.7}) {
    const CutCells cells = cut(body(shells), rotation({1, 2, 3}, angle), Vec3(0.3, 0.6, 0.5));
    expect_exact(cells, 1e-11);
    EXPECT_NEAR(totals(cells).volume, 64 - 10 + 0.125 + 16, 1e-11);
  }
  for (test::NamedSoup shape : test::ten_shapes()) {
    SCOPED_TRACE(shape.name);
    const Mat3 turn = rotation({0.3, 1, -2}, 0.4);
    for (Vec3& x : shape.soup.points) x = (turn * x).cast<float>().cast<double>();
    expect_exact(cut(body(shape.soup), Mat3::Identity(), Vec3(0.1, 0.2, 0.7)), 1e-11);
  }
}

// Proves that a box of triangles is the box of CSG: same cells, moments to rounding, same areas per face.
TEST(TriangleCells, BoxEqualsCsgBox) {
  const Vec3 min(1, 2, 3), max(4, 4.5, 5);
  const Solid csg = Solid::box(min, max, "b"), triangles = body(test::box_soup(min, max));
  Grid grid;
  grid.num_cells = {9, 9, 9};
  for (const double angle : {0.0, 1e-16, 1e-12, 1e-8, 1e-3, 1.0}) {
    SCOPED_TRACE(angle);
    const Mat3 turn = rotation({1, 2, 3}, angle);
    const Vec3 shift = Vec3(4, 4, 4) - turn * Vec3(2.5, 3.25, 4);
    const CutCells a = make_cut_cells(csg.transformed(turn, shift), grid);
    const CutCells b = make_cut_cells(triangles.transformed(turn, shift), grid);
    ASSERT_EQ(a.cells, b.cells);
    for (std::size_t c = 0; c < a.cells.size(); ++c)
      for (int q = 0; q < num_moments; ++q) {
        const int ca = a.cut_of_active[c], cb = b.cut_of_active[c];
        const double x = (ca < 0 ? full_cell_moments() : a.moments[ca])[q];
        const double y = (cb < 0 ? full_cell_moments() : b.moments[cb])[q];
        EXPECT_NEAR(x, y, 2e-13);
      }
  }
}

// Proves that a fine surface has a bounded number of points in every cell, however many triangles (6 on each of 32
// planes, 29 in all where there are more, which is so on 0.3 of a cell's face of 120 rings), and that area, force and
// moment of a pressure stay exact (1e-11), and the second moments of the area those of the facets (1e-3: those below
// 1/128 of a cell have one point before they are compressed).
TEST(TriangleCells, PointsOfFineSurfacesAreBounded) {
  for (const int rings : {40, 120}) {
    const CutCells cells = cut(body(test::sphere_soup(2.7, rings)), Mat3::Identity(), Vec3(0.3, 0.1, 0.7));
    const BoundaryPoints& points = cells.boundary;
    std::vector<int> count(cells.cells.size(), 0);
    std::vector<double> area_of_cell(cells.cells.size(), 0);
    double area = 0, second = 0;
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero(), centre = Vec3::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) centre += points.weight[i] * points.position[i];
    for (std::size_t i = 0; i < points.size(); ++i) area += points.weight[i];
    centre /= area;
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_GT(points.weight[i], 0);
      ++count[points.cell[i]];
      area_of_cell[points.cell[i]] += points.weight[i];
      force += points.weight[i] * points.normal[i];
      moment += points.weight[i] * (points.position[i] - centre).cross(points.normal[i]);
      second += points.weight[i] * (points.position[i] - centre).squaredNorm();
    }
    for (std::size_t c = 0; c < count.size(); ++c)
      EXPECT_LE(count[c], rings == 120 && area_of_cell[c] > 0.3 ? 29 : 6 * 32) << rings;
    const SurfaceTotals exact = surface_totals(*as_triangles(cells.solid));
    EXPECT_NEAR(area / exact.area, 1, 1e-11);
    EXPECT_LT(force.norm() / exact.area, 1e-11);
    EXPECT_LT(moment.norm() / exact.area, 1e-11);
    EXPECT_NEAR(second / (area * 2.7 * 2.7), 1, rings == 40 ? 6e-3 : 1e-3);  // the facets lie inside the sphere
  }
}

}  // namespace
}  // namespace cgcontact::test_triangle_cells
