// Cells of bodies: volumes and areas against formulas, moments, weights, coarse cells, boundary points.
#include "core/base/errors/errors.hpp"
#include "core/cells/moments.hpp"
#include "core/quadrature/gauss_rules.hpp"
#include "tests/unit/core/cut_cells_checks.hpp"

namespace cgcontact::test_cut_cells {
namespace {

std::vector<KnownBody> bodies() {
  std::vector<KnownBody> list;
  const double r = 4;  // 8 cells per diameter
  const Vec3 o = Vec3::Zero();
  const auto sphere = Solid::sphere(o, r, "s");
  list.push_back({"sphere", sphere, 4. / 3 * pi * r * r * r, 4 * pi * r * r, curved});
  list.push_back(
      {"cylinder", Solid::cylinder({0, 0, -3}, {0, 0, 3}, r, "c"), pi * r * r * 6, 2 * pi * r * (r + 6), curved});
  const auto ring =
      Solid::subtract(Solid::cylinder({0, 0, -2}, {0, 0, 2}, r, "o"), Solid::cylinder({0, 0, -2}, {0, 0, 2}, 2.2, "i"));
  const double face = pi * (r * r - 2.2 * 2.2);
  list.push_back({"ring", ring, 4 * face, 2 * face + 2 * pi * (r + 2.2) * 4, curved});
  list.push_back({"sphere minus box", Solid::subtract(sphere, Solid::box(o, {5, 5, 5}, "b")), 7. / 6 * pi * r * r * r,
                  3.5 * pi * r * r + 0.75 * pi * r * r, curved});
  const double d = 3, h = r - d / 2;
  list.push_back({"lens", Solid::intersect(sphere, Solid::sphere({d, 0, 0}, r, "t")), 2 * pi * h * h * (3 * r - h) / 3,
                  4 * pi * r * h, curved});
  list.push_back({"box minus sphere",
                  Solid::subtract(Solid::box({-4, -4, -4}, {4, 4, 4}, "b"), Solid::sphere(o, 3, "s")), 512 - 36 * pi,
                  384 + 36 * pi, curved});
  list.push_back(
      {"Steinmetz",
       Solid::intersect(Solid::cylinder({-9, 0, 0}, {9, 0, 0}, r, "a"), Solid::cylinder({0, -9, 0}, {0, 9, 0}, r, "b")),
       16. / 3 * r * r * r, 16 * r * r, curved});
  const double hole = 1.7, half = std::sqrt(r * r - hole * hole);
  list.push_back({"sphere with hole", Solid::subtract(sphere, Solid::cylinder({0, 0, -9}, {0, 0, 9}, hole, "c")),
                  4. / 3 * pi * half * half * half, 4 * pi * (r + hole) * half, curved});
  list.push_back({"box", Solid::box({-2, -3, -4}, {2, 3, 4}, "b"), 192, 2 * (24 + 48 + 32), planar});
  const Solid corner = Solid::half_space({0, 0, 1.5}, {1, 1, 1}, "h");  // cuts x + y + z <= 1.5 off the cube [0,3]^3
  list.push_back({"cube cut by half-space", Solid::intersect(Solid::box(o, {3, 3, 3}, "b"), corner),
                  1.5 * 1.5 * 1.5 / 6, 1.5 * 1.5 * (1.5 + std::sqrt(3.) / 2), planar});
  list.push_back({"overlapping boxes",
                  Solid::unite(Solid::box(o, {4, 4, 4}, "a"), Solid::box({2, 2, 2}, {6, 6, 6}, "b")), 120, 168,
                  planar});
  return list;
}

// All kinds of bodies.
TEST(CutCells, VolumesAndAreas) {
  check_totals(bodies(), {Mat3::Identity(), rotation({1, 2, 3}, 0.7), rotation({0, 1, 0}, 0.3)});
}

// Proves that coarse grids work: 3 cells per diameter, where the surface turns much within a cell. 1e-6 is far below
// the discretisation error there.
TEST(CutCells, ThreeCellsPerDiameter) {
  const double r = 1.5;
  for (const Vec3& fraction : {Vec3(0, 0, 0), Vec3(0.31, 0.77, 0.5)}) {
    const Totals sphere = totals(cut(Solid::sphere({0, 0, 0}, r, "s"), Mat3::Identity(), fraction));
    EXPECT_NEAR(sphere.volume / (4. / 3 * pi * r * r * r), 1, 1e-6);
    EXPECT_NEAR(sphere.area / (4 * pi * r * r), 1, 1e-6);
    const Totals cylinder =
        totals(cut(Solid::cylinder({0, 0, 0}, {0, 0, 2}, r, "c"), rotation({1, 2, 3}, 1.0), fraction));
    EXPECT_NEAR(cylinder.volume / (2 * pi * r * r), 1, 1e-6);
    EXPECT_NEAR(cylinder.area / (2 * pi * r * (r + 2)), 1, 1e-6);
    const Totals tiny = totals(cut(Solid::sphere({0, 0, 0}, 0.2, "s"), Mat3::Identity(), fraction));
    EXPECT_NEAR(tiny.volume / (4. / 3 * pi * 0.008), 1, 1e-6);
  }
}

double monomial(const Vec3& x, int a, int b, int c) {
  return std::pow(x[0], a) * std::pow(x[1], b) * std::pow(x[2], c);
}

/// Integral of a polynomial of degree <= 4 per variable over the body from the weights of the cells.
template <class Function>
double integrate(const CutCells& cells, const Function& f) {
  const GaussRule& gauss = gauss_rule(5);
  double sum = 0, weights[125];
  for (std::size_t a = 0; a < cells.cells.size(); ++a) {
    const int cut_cell = cells.cut_of_active[a];
    fitted_weights(cut_cell < 0 ? full_cell_moments() : cells.moments[cut_cell], 5, weights);
    for (int q = 0; q < 125; ++q) {
      const Vec3 x(cells.cells[a][0] + gauss.node[q / 25], cells.cells[a][1] + gauss.node[q / 5 % 5],
                   cells.cells[a][2] + gauss.node[q % 5]);
      sum += weights[q] / 8 * f(x);
    }
  }
  return sum;
}

// Proves moments and boundary points against each other: the divergence theorem for all monomials of degree <= 3, which
// is what makes constant stress an exact solution. Curved: 1e-9 relative to the sum of absolute values.
TEST(CutCells, DivergenceTheorem) {
  for (const KnownBody& body : bodies()) {
    SCOPED_TRACE(body.name);
    const CutCells cells =
        cut(body.solid.transformed(Mat3::Identity(), Vec3::Zero(), 0.7), rotation({1, 2, 3}, 0.4), {0.2, 0.6, 0.9});
    for (int a = 0; a <= 3; ++a)
      for (int b = 0; a + b <= 3; ++b)
        for (int c = 0; a + b + c <= 3; ++c)
          for (int d = 0; d < 3; ++d) {
            const Vec3 origin = Vec3::Constant(4);
            int e[3] = {a, b, c};
            const int power = e[d]--;
            const double volume = power == 0 ? 0 : integrate(cells, [&](const Vec3& x) {
              return power * monomial(x - origin, e[0], e[1], e[2]);
            });
            double surface = 0, size = 0;
            for (std::size_t i = 0; i < cells.boundary.size(); ++i) {
              const double term = cells.boundary.weight[i] * monomial(cells.boundary.position[i] - origin, a, b, c) *
                                  cells.boundary.normal[i][d];
              surface += term;
              size += std::abs(term);
            }
            EXPECT_NEAR(surface, volume, (body.tolerance == planar ? 1e-13 : 1e-8) * size);
          }
  }
}

// Proves that the weights reproduce the moments they are made of (1e-13 of a full cell).
TEST(CutCells, FittedWeightsReproduceMoments) {
  const CutCells cells = cut(bodies()[3].solid, rotation({1, 1, 0}, 0.3), {0.3, 0.1, 0.7});
  for (int n : {3, 5}) {
    const GaussRule& gauss = gauss_rule(n);
    std::vector<double> weights(n * n * n);
    for (const Moments& m : cells.moments) {
      fitted_weights(m, n, weights.data());
      Moments sum{};
      for (int q = 0; q < n * n * n; ++q) {
        double l[3][moment_degree + 1];
        const int index[3] = {q / (n * n), q / n % n, q % n};
        for (int k = 0; k < 3; ++k) legendre_values(2 * gauss.node[index[k]] - 1, l[k]);
        add_product(sum, weights[q], l[0], l[1], l[2]);
      }
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
          for (int k = 0; k < n; ++k) EXPECT_NEAR(sum[(i * 5 + j) * 5 + k], m[(i * 5 + j) * 5 + k], 8e-13);
    }
    fitted_weights(full_cell_moments(), n, weights.data());
    double total = 0;
    for (double w : weights) total += w;
    EXPECT_NEAR(total, 8, 1e-14);
  }
}

// Proves that moments of coarse cells from children equal those computed directly on the coarse grid (1e-12 of a cell,
// curved rule on the twice larger cell included).
TEST(CutCells, CoarseMomentsAreInherited) {
  const KnownBody all[] = {bodies()[0], bodies()[8], bodies()[10]};
  for (const KnownBody& body : all) {
    SCOPED_TRACE(body.name);
    const Solid fine_solid = body.solid.transformed(rotation({3, 1, 2}, 0.5), Vec3::Zero(), 1.5)
                                 .transformed(Mat3::Identity(), Vec3::Constant(9.3));
    Grid fine_grid, coarse_grid;
    fine_grid.num_cells = {24, 24, 24};
    coarse_grid.num_cells = {12, 12, 12};
    const CutCells fine = make_cut_cells(fine_solid, fine_grid);
    const CutCells coarse = make_cut_cells(fine_solid.transformed(Mat3::Identity(), Vec3::Zero(), 0.5), coarse_grid);
    for (std::size_t a = 0; a < coarse.cells.size(); ++a) {
      std::array<const Moments*, 8> children{};
      for (int c = 0; c < 8; ++c) {
        const Index3& p = coarse.cells[a];
        const int child = fine.find({2 * p[0] + (c & 1), 2 * p[1] + (c >> 1 & 1), 2 * p[2] + (c >> 2 & 1)});
        if (child < 0) continue;
        const int cut_cell = fine.cut_of_active[child];
        children[c] = cut_cell < 0 ? &full_cell_moments() : &fine.moments[cut_cell];
      }
      const Moments inherited = coarse_moments(children);
      const int cut_cell = coarse.cut_of_active[a];
      const Moments& direct = cut_cell < 0 ? full_cell_moments() : coarse.moments[cut_cell];
      for (int q = 0; q < num_moments; ++q)
        EXPECT_NEAR(inherited[q], direct[q], body.tolerance == planar ? 1e-13 : 1e-10);
    }
  }
}

// Proves that moments can be expressed in a neighbour's coordinates (exact change of polynomial basis).
TEST(CutCells, MomentsMoveToANeighbour) {
  double a[5], b[5], c[5];
  Moments here{}, there{};
  for (const Vec3& x : {Vec3(0.3, -0.7, 0.9), Vec3(-0.1, 0.4, 0.2)}) {
    legendre_values(x[0], a), legendre_values(x[1], b), legendre_values(x[2], c);
    add_product(here, 1.7, a, b, c);
    legendre_values(x[0] + 2, a), legendre_values(x[1], b), legendre_values(x[2] - 2, c);
    add_product(there, 1.7, a, b, c);
  }
  const Moments moved = shifted_moments(here, {1, 0, -1});
  for (int q = 0; q < num_moments; ++q) EXPECT_NEAR(moved[q], there[q], 1e-14 * 321 * 321);
}

// Proves the rule on planar facets: all polynomials of total degree <= 5 in the plane of each face of a rotated box, to
// rounding, although the faces are cut into facets by the cells.
TEST(CutCells, PlanarFacetsAreOfDegreeFive) {
  const Mat3 turn = rotation({1, 2, 3}, 0.7);
  const Vec3 half(2, 1.5, 1);
  const CutCells cells = cut(Solid::box(-half, half, "b"), turn, {0.4, 0.2, 0.6});
  Vec3 min, max;
  ASSERT_TRUE(cells.solid.bounding_box(min, max));
  const Vec3 centre = 0.5 * (min + max);
  for (int face = 0; face < 6; ++face)
    for (int a = 0; a <= 5; ++a)
      for (int b = 0; a + b <= 5; ++b) {
        const int s = (face / 2 + 1) % 3, t = (face / 2 + 2) % 3;
        double sum = 0;
        for (std::size_t i = 0; i < cells.boundary.size(); ++i) {
          if (cells.boundary.surface[i] != face) continue;
          const Vec3 x = turn.transpose() * (cells.boundary.position[i] - centre);
          sum += cells.boundary.weight[i] * std::pow(x[s], a) * std::pow(x[t], b);
        }
        auto line = [](double h, int n) { return n % 2 ? 0.0 : 2 * std::pow(h, n + 1) / (n + 1); };
        EXPECT_NEAR(sum, line(half[s], a) * line(half[t], b), 2e-13 * std::pow(2.0, a + b) * 8);
      }
}

// Proves that dividers do not change the area of any cell and that facets end exactly at them: the area on one side of
// a plane through a sphere is that of the cap (2 pi r h), on one side of a plane through the centre of a box one half.
TEST(CutCells, DividersSplitFacets) {
  const std::vector<Plane> dividers{{Vec3(1, 2, -1).normalized(), 4.1},
                                    {Vec3(0, 0, 2), 9.3},
                                    {Vec3(1, 0, 0.1), 5.2},
                                    {Vec3(1, 0, 0.1), 5.7},
                                    {Vec3(1, 0, 0.1), 6.3},
                                    {Vec3(0.1, 1, 0), 5.01}};
  const Solid sphere = Solid::sphere({5.1, 5.2, 5.3}, 4, "s");
  const Solid box = Solid::box({-3, -2, -2.5}, {3, 2, 2.5}, "b").transformed(rotation({1, 2, 3}, 0.6), {5.1, 5.2, 5.3});
  Grid grid;
  grid.num_cells = {10, 10, 10};
  for (const Solid& solid : {sphere, box}) {
    const bool is_sphere = solid.surfaces().size() == 1;
    const CutCells cells = make_cut_cells(solid, grid);
    const double tolerance = is_sphere ? 1e-8 : 1e-13;
    const double area = is_sphere ? 64 * pi : 2 * (24 + 30 + 20);
    EXPECT_NEAR(area_by_cells(cells, {}, 3) / area, 1, tolerance);
    EXPECT_NEAR(area_by_cells(cells, dividers, 2) / area, 1, is_sphere ? 1e-7 : 1e-13);
    for (const Plane& plane : dividers) {
      const double length = plane.normal.norm();
      const double height = 4 - (plane.normal.dot(Vec3(5.1, 5.2, 5.3)) - plane.offset) / length;
      Plane used = plane;
      if (!is_sphere) used.offset = plane.normal.dot(Vec3(5.1, 5.2, 5.3));
      BoundaryPoints points;
      for (std::size_t a = 0; a < cells.cells.size(); ++a)
        boundary_points_of_cell(cells, static_cast<int>(a), all_surfaces(cells), {used, dividers[1]}, 3, points);
      double below = 0;
      for (std::size_t i = 0; i < points.size(); ++i)
        if (used.normal.dot(points.position[i]) < used.offset) below += points.weight[i];
      EXPECT_NEAR(below, is_sphere ? 2 * pi * 4 * height : area / 2, (is_sphere ? 1e-8 : 1e-13) * area);
    }
  }
}

// Proves that asking for some surfaces gives these only.
TEST(CutCells, SurfacesAreSelected) {
  const CutCells cells = cut(bodies()[2].solid, rotation({1, 2, 3}, 0.7), {0.1, 0.2, 0.3});
  BoundaryPoints points;
  for (std::size_t a = 0; a < cells.cells.size(); ++a)
    boundary_points_of_cell(cells, static_cast<int>(a), {3}, {}, 3, points);
  double area = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(points.surface[i], 3);
    EXPECT_NEAR(cells.solid.surfaces()[3].signed_distance(points.position[i]), 0, 1e-13);
    area += points.weight[i];
  }
  EXPECT_NEAR(area, 2 * pi * 2.2 * 4, 1e-8 * area);
  for (std::size_t i = 0; i < points.size(); ++i)  // the wall of the hole: outward of the body is towards the axis
    EXPECT_LT(points.normal[i].dot(cells.solid.surfaces()[3].gradient(points.position[i])), -0.999);
}

// Proves where points are found: inside, on faces between cells, slightly outside of the body, and not far away.
TEST(CutCells, PointsAreLocated) {
  Grid grid;
  grid.num_cells = {6, 6, 6};
  const CutCells cells = make_cut_cells(Solid::box({1, 1, 1}, {4, 4, 4}, "b"), grid);
  EXPECT_EQ(cells.locate({2.5, 2.5, 2.5}), cells.find({2, 2, 2}));
  EXPECT_EQ(cells.locate({4, 2.5, 2.5}), cells.find({3, 2, 2}));
  EXPECT_EQ(cells.locate({1, 1, 1}), cells.find({1, 1, 1}));
  EXPECT_EQ(cells.locate({4.7, 4.2, 3.5}), cells.find({3, 3, 3}));
  EXPECT_EQ(cells.locate({5.5, 2, 2}), -1);
  EXPECT_EQ(cells.locate({-3, 2, 2}), -1);
}

// Proves that bodies that cannot be computed are refused, and that one that just fits is not.
TEST(CutCells, EmptyAndProtrudingBodiesAreRefused) {
  Grid grid;
  grid.num_cells = {4, 4, 4};
  const Solid box = Solid::box({0, 0, 0}, {4, 4, 4}, "b");
  EXPECT_NO_THROW(make_cut_cells(box, grid));
  EXPECT_THROW(make_cut_cells(Solid::subtract(box, Solid::box({-1, -1, -1}, {5, 5, 5}, "c")), grid), InputError);
  EXPECT_THROW(make_cut_cells(Solid::box({0, 0, 0}, {4, 4, 4.1}, "b"), grid), InputError);
  EXPECT_THROW(make_cut_cells(Solid::box({0, 0, 0}, {4, 4, 7}, "b"), grid), InputError);
  EXPECT_THROW(make_cut_cells(Solid::unite(box, Solid::sphere({20, 2, 2}, 1, "far")), grid), InputError);
  EXPECT_THROW(make_cut_cells(Solid::half_space({2, 2, 2}, {0, 0, 1}, "h"), grid), InputError);
  EXPECT_THROW(make_cut_cells(Solid(), grid), InputError);
}

}  // namespace
}  // namespace cgcontact::test_cut_cells
