/// Patches, plain SPR and the error estimate on bodies whose cells have several sizes. SPR-C: test_exact_stress.cpp.
#include <gtest/gtest.h>

#include "recovery/error/error_estimate.hpp"
#include "recovery/patch/cells_in_box.hpp"
#include "recovery/spr/cell_stress.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/polynomial_displacement.hpp"

namespace cgcontact::test_refined {
namespace {

using test::Displacement;

const double E = 3, nu = 0.3;
const Scales scales{0.5, 2};

struct Case {
  std::string name;
  Solid solid;
  Vec3 fine;  ///< where the smallest cells are
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

/// Cells of five sizes.
CutCells refined(const Case& c) { return test::cut_refined(c.solid, test::odd_grid(5, 0.3), c.fine, 1. / 16, 0.5); }

/// One body with its mesh and patches.
struct Body {
  CutCells cc;
  ElasticSystem system = make_elastic_system({&cc}, {Material{E, nu}}, scales, 0.01);
  const BodyMesh& mesh = system.meshes[0];
  PatchSet patches = make_patches(mesh);
  RecoveredField field{Subset(mesh.num_nodes), CoefficientView("field", mesh.num_nodes)};

  explicit Body(CutCells cells) : cc(std::move(cells)) {}

  /// Values in units of Scales::length; those of constrained nodes are the means of their masters'.
  RealView displacements(const std::function<Vec3(const Vec3&)>& value) const {
    return consistent(test::nodal_field(system, [&](const Vec3& x) -> Vec3 { return value(x) / scales.length; }));
  }
  RealView consistent(RealView u) const {
    for (const NodeConstraint& constraint : mesh.constraints)
      for (int i = 0; i < 3; ++i) {
        double sum = 0;
        for (const auto& [master, weight] : constraint.masters) sum += weight * u(dof_of(master, i));
        u(dof_of(constraint.node, i)) = sum;
      }
    return u;
  }
  /// In units of Scales::stress, grid axes; x in grid coordinates.
  Sym3 exact(const Displacement& u, const Vec3& x) const {
    const Mat3& R = cc.grid.rotation;
    return voigt(R.transpose() * u.stress(cc.grid.to_global(x)) * R) / scales.stress;
  }
  Sym3 recovered(int cell, const Vec3& x) const {
    const Vec3 xi = cell_coordinates(cc, cell, x);
    Sym3 s;
    evaluate_recovered(mesh, field, cell, xi.data(), s.data());
    return s;
  }
  bool is_full(int cell) const { return cc.cut_of_active[cell] < 0; }
  /// Whether cells of another size touch a cell.
  bool meets_other_level(int cell) const {
    bool found = false;
    const Vec3 low = cc.corner(cell), margin = Vec3::Constant(1e-6 * cc.size(cell));
    each_cell_in(cc, low - margin, low + Vec3::Constant(cc.size(cell)) + margin,
                 [&](int other) { found = found || cc.level(other) != cc.level(cell); });
    return found;
  }
};

class Refined : public testing::TestWithParam<Case> {};

/// The patch of a free node: the cells with a corner at its position, at most two sizes. Constrained nodes have none.
TEST_P(Refined, PatchesOfFreeNodes) {
  const Body b(refined(GetParam()));
  ASSERT_EQ(b.cc.num_levels(), 5);
  int of_two_sizes = 0, full = 0;
  for (int n = 0; n < b.mesh.num_nodes; ++n) {
    std::vector<int> cells(b.patches.cells.begin() + b.patches.begin[n],
                           b.patches.cells.begin() + b.patches.begin[n + 1]);
    full += b.patches.full[n];
    if (!b.mesh.is_free(n)) {
      EXPECT_TRUE(cells.empty());
      continue;
    }
    double volume = 0;
    for (int c : cells) volume += b.cc.volume_fraction(c);
    EXPECT_GE(volume, 1 - 1e-12);
    if (b.patches.grown[n]) continue;
    std::vector<int> expected;
    int coarsest = b.cc.num_levels(), finest = 0;
    for (std::size_t c = 0; c < b.cc.cells.size(); ++c) {
      const int cell = static_cast<int>(c);
      const Vec3 d = (b.mesh.node_position(n) - b.cc.corner(cell)) / b.cc.size(cell);
      if (((d.array() == 0) || (d.array() == 1)).all()) {
        expected.push_back(cell);
        coarsest = std::min(coarsest, b.cc.level(cell));
        finest = std::max(finest, b.cc.level(cell));
      }
    }
    EXPECT_EQ(cells, expected);
    EXPECT_EQ(coarsest, level_of(b.mesh, n));
    EXPECT_LE(finest - coarsest, 1);
    of_two_sizes += finest > coarsest;
  }
  EXPECT_GT(of_two_sizes, 50);
  EXPECT_GT(full, 50);
}

/// Exact integrals of a linear stress come out of all patches, slivers and levels that meet included.
TEST_P(Refined, LinearStress) {
  const Body b(refined(GetParam()));
  const Displacement u = Displacement::random(2, E, nu);
  const Subset cells(static_cast<int>(b.cc.cells.size()));
  const StressIntegrals integrals = integrate_stress(
      b.mesh,
      [&](int cell) {
        const double size = b.cc.size(cell);
        const Vec3 x = middle_of_cell(b.cc, cell);
        CellPolynomial p = CellPolynomial::Zero();
        p.col(0) = b.exact(u, x);
        for (int i = 0; i < 3; ++i)
          p.col(1 + i) = (b.exact(u, x + size * Vec3::Unit(i)) - b.exact(u, x - size * Vec3::Unit(i))) / 2;
        return p;
      },
      cells);
  CellStressView stress("stress", cells.size());
  double least = 1;
  for (int e = 0; e < cells.size(); ++e) {
    least = std::min(least, b.cc.volume_fraction(e));
    for (int k = 0; k < 6; ++k)
      for (int t = 0; t < num_terms; ++t) stress(e, k, t) = integrals.stress[e](k, t);
  }
  EXPECT_LT(least, 1e-4);
  EXPECT_EQ(fit_patches(b.mesh, b.patches, stress, cells, b.field), 0);
  for (int n = 0; n < b.mesh.num_nodes; ++n) {
    const Vec3 x = b.mesh.node_position(n);
    const double unit = unit_of(b.mesh, n);
    const Sym3 s = b.exact(u, x);
    for (int i = 0; i <= 3; ++i) {
      const Sym3 expected = i == 0 ? s : Sym3(b.exact(u, x + unit * Vec3::Unit(i - 1)) - s);
      for (int k = 0; k < 6; ++k) EXPECT_NEAR(b.field.values(n, k, i), expected[k], 1e-10 * s.norm());
    }
  }
}

/// A linear displacement: the stress is exact everywhere, and the error estimate is zero.
TEST_P(Refined, LinearDisplacement) {
  const Body b(refined(GetParam()));
  const Displacement u = Displacement::random(1, E, nu);
  const RealView nodal = b.displacements([&](const Vec3& x) { return u.value(x); });
  EXPECT_EQ(recover_all(b.mesh, b.patches, nodal, b.field, 1000), 0);
  for (std::size_t p = 0; p < b.cc.boundary.size(); ++p) {
    const Vec3& x = b.cc.boundary.position[p];
    const Sym3 s = b.exact(u, x);
    EXPECT_LT((b.recovered(b.cc.boundary.cell[p], x) - s).norm(), 1e-11 * s.norm());
  }
  const EnergySums sums =
      estimate_error(b.mesh, scales, b.field, nodal, [&](const Vec3& x) { return voigt(u.stress(x)); });
  EXPECT_LT(sums.error, 1e-22 * sums.solution);
  EXPECT_LT(sums.recovered_error, 1e-22 * sums.solution);
  // sigma : epsilon is constant
  double volume = 0;
  for (std::size_t e = 0; e < b.cc.cells.size(); ++e)
    volume += b.cc.volume_fraction(static_cast<int>(e)) * std::pow(b.mesh.h(static_cast<int>(e)), 3);
  const Mat3 s = u.stress(Vec3::Zero()) / scales.stress;
  const double energy = ((1 + nu) * s.squaredNorm() - nu * s.trace() * s.trace()) / b.mesh.modulus;
  EXPECT_NEAR(sums.solution, energy * volume, 1e-11 * energy * volume);
}

/// sigma* is continuous to rounding wherever two cells meet, whatever the displacement.
TEST_P(Refined, Continuous) {
  const Body b(refined(GetParam()));
  const RealView u = b.consistent(test::random_vector(b.system.num_dofs(), 5));
  recover_all(b.mesh, b.patches, u, b.field);
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  int of_one_size = 0, of_two_sizes = 0;
  for (std::size_t c = 0; c < b.cc.cells.size(); ++c) {
    const int cell = static_cast<int>(c);
    const double size = b.cc.size(cell);
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2, side = face % 2;
      Vec3 position(uniform(generator), uniform(generator), uniform(generator));
      position[axis] = side;
      const Vec3 x = b.cc.corner(cell) + size * position;
      const int other = cell_at(b.cc, x + (side ? 0.25 : -0.25) * size * Vec3::Unit(axis));
      if (other < 0) continue;
      const Sym3 s = b.recovered(cell, x);
      EXPECT_LT((b.recovered(other, x) - s).norm(), 1e-12 * (s.norm() + 1 / size));
      ++(b.cc.level(other) == b.cc.level(cell) ? of_one_size : of_two_sizes);
    }
  }
  EXPECT_GT(of_one_size, 100);
  EXPECT_GT(of_two_sizes, 100);
}

/// Where cells of several sizes meet, polynomials that are made where they are asked for are those of all nodes.
TEST_P(Refined, InteriorFit) {
  const Body b(refined(GetParam()));
  const RealView u = b.consistent(test::random_vector(b.system.num_dofs(), 5));
  recover_all(b.mesh, b.patches, u, b.field);
  const Subset beside = nodes_beside_interior(b.mesh, CellLists());
  const InteriorFit fit(b.mesh, u, false);
  std::array<int, 2> inside{0, 0};  // with large cells, with small ones
  for (int n = 0; n < b.mesh.num_nodes; ++n) {
    if (beside.row(n) >= 0) continue;
    ++inside[level_of(b.mesh, n) > 1];
    Coefficients a;
    fit.at(n, a.data());
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.field.at(n)));
  }
  EXPECT_GT(inside[0] + inside[1], 10);
  EXPECT_GT(inside[1], 0);
}

/// All cells divided once are those of a grid of half the size.
TEST_P(Refined, AllCellsDivided) {
  Grid grid = test::odd_grid(5, 0.3);
  const Solid& solid = GetParam().solid;
  const Body divided(test::cut_refined(solid, grid, Vec3::Zero(), 0.5, 0.0));
  ASSERT_EQ(divided.cc.num_levels(), 2);
  grid.cell_size /= 2;
  for (int& n : grid.num_cells) n *= 2;
  const Body uniform(test::cut(solid, grid));
  ASSERT_EQ(divided.cc.cells, uniform.cc.cells);
  const auto value = [](const Vec3& x) { return Vec3(std::sin(3 * x[0] + x[1]), std::cos(4 * x[1]), x[0] * x[2]); };
  for (const Body* b : {&divided, &uniform}) recover_all(b->mesh, b->patches, b->displacements(value), b->field);
  for (std::size_t c = 0; c < uniform.cc.cells.size(); ++c) {
    const int cell = static_cast<int>(c);
    const Vec3 x = middle_of_cell(uniform.cc, cell) + Vec3(0.1, 0.3, -0.4);
    const Sym3 s = uniform.recovered(cell, x);
    EXPECT_LT((divided.recovered(cell, x / 2) - s).norm(), 1e-10 * s.norm());
  }
  EXPECT_EQ(std::count(divided.patches.grown.begin(), divided.patches.grown.end(), 1),
            std::count(uniform.patches.grown.begin(), uniform.patches.grown.end(), 1));
}

INSTANTIATE_TEST_SUITE_P(
    Bodies, Refined,
    testing::Values(
        Case{"turned_box", Solid::box(Vec3(0.1, 0.15, 0.2), Vec3(0.9, 0.8, 0.75), "box"), {0.4, 0.45, 0.75}},
        Case{"ball", Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.41, "sphere"), {0.5, 0.5, 0.91}}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace cgcontact::test_refined
