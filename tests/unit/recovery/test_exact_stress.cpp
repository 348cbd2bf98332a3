/// Exact data: a stress that the polynomials can represent, in equilibrium with its tractions and its body force, comes
/// out of the constrained recovery as it went in, on unfitted bodies with plane and curved faces.
#include <gtest/gtest.h>

#include "kernels/mesh/mean_dilatation.hpp"
#include "recovery/constrained/recover_stress.hpp"
#include "tests/support/bodies.hpp"
#include "tests/support/polynomial_displacement.hpp"

namespace cgcontact::test_exact_stress {
namespace {

using test::Displacement;

const double E = 3, nu = 0.3;
const Scales scales{0.5, 2};

struct Case {
  std::string name;
  Solid solid;
  double angle;
  bool refined = false;  ///< cells of four sizes, towards a point of its surface
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

/// One body, its exact stress as data, recovered.
struct Recovered {
  CutCells cc;
  Displacement u;
  ElasticSystem system = make_elastic_system({&cc}, {Material{E, nu}}, scales, 0.01);
  const BodyMesh& mesh = system.meshes[0];
  PatchSet patches = make_patches(mesh);
  BoundaryData boundary;
  RecoveredField field{Subset(mesh.num_nodes), CoefficientView("field", mesh.num_nodes)};
  RecoveryCounts counts;
  PatchStates states;

  Recovered(const Case& c, const Displacement& displacement, int degree, int rings, bool force)
      : cc(c.refined ? test::cut_refined(c.solid, test::odd_grid(6, c.angle), Vec3(0.5, 0.5, 0.85), 1. / 8, 0.5)
                     : test::cut(c.solid, test::odd_grid(9, c.angle))),
        u(displacement) {
    boundary.conditions.resize(1);
    boundary.conditions[0].traction = [this](const Vec3& x, const Vec3& n) -> Vec3 { return u.stress(x) * n; };
    boundary.condition_of_point.assign(cc.boundary.size(), 0);
    boundary.pair_of_point.assign(cc.boundary.size(), -1);
    if (force) boundary.body_force_at = [this](const Vec3& x) { return u.body_force(x); };
    const CellStress stress = [this](int cell) { return expanded(cell); };
    const Subset cells(static_cast<int>(cc.cells.size()));
    const StressIntegrals integrals = integrate_stress(mesh, stress, cells);
    CellStressView linear("linear", cells.size());
    for (int e = 0; e < cells.size(); ++e)
      for (int k = 0; k < 6; ++k)
        for (int t = 0; t < num_terms; ++t) linear(e, k, t) = integrals.stress[e](k, t);
    fit_patches(mesh, patches, linear, cells, field);
    RecoveryOptions options;
    options.degree = {degree, degree, degree};
    options.quadratic_rings = rings;
    ConstrainedRecovery recovery = recover_constrained(HostExec(), {{&mesh, &patches, &boundary, field, stress}},
                                                       RealView("u", system.num_dofs()), scales, options);
    counts = recovery.counts;
    states = std::move(recovery.states[0]);
    field.quadratic = std::make_shared<QuadraticTerms>(std::move(recovery.quadratic[0]));
  }

  /// In units of Scales::stress, grid axes; x in grid coordinates.
  Sym3 exact(const Vec3& x) const {
    const Mat3& R = cc.grid.rotation;
    return voigt(R.transpose() * u.stress(cc.grid.to_global(x)) * R) / scales.stress;
  }
  /// Differences are exact for quadratic polynomials.
  CellPolynomial expanded(int cell) const {
    const double size = cc.size(cell);
    const Vec3 x = cc.corner(cell) + Vec3::Constant(size / 2);
    const auto at = [&](int i, double a, int j, double b) {
      return exact(x + size * (a * Vec3::Unit(i) + b * Vec3::Unit(j)));
    };
    CellPolynomial p;
    p.col(0) = exact(x);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      p.col(1 + i) = (at(i, 1, j, 0) - at(i, -1, j, 0)) / 2;
      p.col(4 + i) = (at(i, 1, j, 0) - 2 * exact(x) + at(i, -1, j, 0)) / 2;
      p.col(7 + i) = (at(i, 1, j, 1) - at(i, 1, j, -1) - at(i, -1, j, 1) + at(i, -1, j, -1)) / 4;
    }
    return p;
  }
  /// A polynomial has the degree that was asked for, and so have those that it is the mean of.
  bool is_quadratic_at(int node) const {
    bool all = true;
    each_master(mesh, node, [&](int master, double) { all = all && field.quadratic->of_node(master); });
    return all;
  }
  bool is_quadratic(int cell) const {
    for (int node : mesh.cell_nodes[cell])
      if (!is_quadratic_at(node)) return false;
    return true;
  }

  /// max_lowered_fraction: fraction of the boundary points next to patches that had to be lowered, which are left out.
  void expect_exact(int degree, double max_lowered_fraction = 0.1) const {
    double largest = 0, worst = 0, worst_node = 0;
    int skipped = 0;
    for (std::size_t p = 0; p < cc.boundary.size(); ++p) {
      const Vec3& x = cc.boundary.position[p];
      if (degree == 2 && !is_quadratic(cc.boundary.cell[p])) {
        ++skipped;
        continue;
      }
      const Vec3 xi = cell_coordinates(cc, cc.boundary.cell[p], x);
      Sym3 s;
      evaluate_recovered(mesh, field, cc.boundary.cell[p], xi.data(), s.data());
      largest = std::max(largest, exact(x).norm());
      worst = std::max(worst, (s - exact(x)).norm());
    }
    for (int n = 0; n < mesh.num_nodes; ++n) {
      if (degree == 2 && !is_quadratic_at(n)) continue;
      const Sym3 s = exact(mesh.node_position(n));
      for (int k = 0; k < 6; ++k) worst_node = std::max(worst_node, std::abs(field.values(n, k, 0) - s[k]));
    }
    EXPECT_LT(worst, 1e-10 * largest);
    EXPECT_LT(worst_node, 1e-10 * largest);
    EXPECT_LE(skipped, max_lowered_fraction * cc.boundary.size());
    // On refined grids linear polynomials, where quadratic ones were asked for and are not possible, contradict the
    // data at some nodes (2 of the box).
    long long conflicting = counts.statuses[static_cast<int>(PatchStatus::conflicting)];
    for (int n = 0; n < mesh.num_nodes; ++n)
      if (degree == 2 && !mesh.level_meshes.empty() && mesh.is_free(n) && !is_quadratic_at(n) &&
          states.status[n] == PatchStatus::conflicting)
        --conflicting;
    EXPECT_EQ(conflicting, 0);
    EXPECT_EQ(counts.statuses[static_cast<int>(PatchStatus::singular)], 0);
    if (degree == 2) {
      EXPECT_EQ(counts.quadratic + counts.lowered, mesh.num_nodes - static_cast<int>(mesh.constraints.size()));
    }
  }
};

class ExactStress : public testing::TestWithParam<Case> {};

TEST_P(ExactStress, LinearWithConstantForce) {
  Recovered(GetParam(), Displacement::random(2, E, nu), 1, 1, true).expect_exact(1);
}

TEST_P(ExactStress, QuadraticWithLinearForce) {
  Recovered(GetParam(), Displacement::random(3, E, nu), 2, 2, true).expect_exact(2);
}

/// Many patches at edges and corners hold too little for degree 2 then.
TEST_P(ExactStress, QuadraticOverOneRing) {
  Recovered(GetParam(), Displacement::random(3, E, nu), 2, 1, true).expect_exact(2, 0.4);
}

TEST_P(ExactStress, QuadraticWithoutForce) {
  Recovered(GetParam(), Displacement::harmonic(E, nu), 2, 2, false).expect_exact(2);
}

INSTANTIATE_TEST_SUITE_P(
    Bodies, ExactStress,
    testing::Values(Case{"box", Solid::box(Vec3(0.1, 0.15, 0.2), Vec3(0.9, 0.8, 0.75), "box"), 0.0},
                    Case{"turned_box", Solid::box(Vec3(0.1, 0.15, 0.2), Vec3(0.9, 0.8, 0.75), "box"), 0.3},
                    Case{"sphere", Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.41, "sphere"), 0.3},
                    Case{"cylinder", Solid::cylinder(Vec3(0.5, 0.5, 0.15), Vec3(0.45, 0.55, 0.85), 0.33, "cylinder"),
                         0.2},
                    Case{"refined_box", Solid::box(Vec3(0.1, 0.15, 0.2), Vec3(0.9, 0.8, 0.85), "box"), 0.3, true},
                    Case{"refined_sphere", Solid::sphere(Vec3(0.5, 0.5, 0.45), 0.4, "sphere"), 0.3, true}),
    [](const auto& test) { return test.param.name; });

/// A plate a fifth of a cell thick carries no quadratic polynomials: linear ones, counted.
TEST(DegreeOfThinPlate, IsLoweredEverywhere) {
  const Case plate{"plate", Solid::box(Vec3(0.1, 0.15, 0.5), Vec3(0.9, 0.8, 0.522), "plate"), 0.0};
  const Recovered quadratic(plate, Displacement::random(2, E, nu), 2, 2, true);
  EXPECT_EQ(quadratic.counts.quadratic, 0);
  EXPECT_EQ(quadratic.counts.lowered, quadratic.mesh.num_nodes);
  EXPECT_GT(quadratic.counts.statuses[static_cast<int>(PatchStatus::degree_lowered)], 0);
  quadratic.expect_exact(1);
}

/// Closed form against points.
TEST(CellStress, IntegralsOfDisplacements) {
  const CutCells cc = test::cut(Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.41, "sphere"), test::odd_grid(5, 0.3));
  const ElasticSystem system = make_elastic_system({&cc}, {Material{E, nu}}, scales, 0.01);
  const BodyMesh& mesh = system.meshes[0];
  const RealView u = test::random_vector(system.num_dofs(), 3);
  const Subset cells(static_cast<int>(cc.cells.size()));
  const StressIntegrals integrals = integrate_stress(mesh, stress_of_displacements(mesh, u), cells);
  for (int e = 0; e < cells.size(); ++e) {
    double weights[125], corner[8][3];
    fitted_weights(cc.cut_of_active[e] < 0 ? full_cell_moments() : cc.moments[cc.cut_of_active[e]], 5, weights);
    corner_values(mesh.cell_nodes[e], u, corner);
    CellPolynomial sum = CellPolynomial::Zero();
    double largest = 0, square = 0;
    for (int q = 0; q < 125; ++q) {
      const double xi[3] = {Gauss5::point[q / 25], Gauss5::point[q / 5 % 5], Gauss5::point[q % 5]};
      const double d[3] = {xi[0] / 2, xi[1] / 2, xi[2] / 2};
      double s[6], p[10];
      hex_stress(mesh.law, corner, mean_dilatation(mesh, e, corner), xi, s);
      Polynomial<2>::terms(d, p);
      for (int k = 0; k < 6; ++k) {
        largest = std::max(largest, std::abs(mesh.stress_factor(e) * s[k]));
        square += weights[q] / 8 * std::pow(mesh.stress_factor(e) * s[k], 2);
        for (int t = 0; t < 10; ++t) sum(k, t) += mesh.stress_factor(e) * weights[q] / 8 * s[k] * p[t];
      }
    }
    EXPECT_LT((sum - integrals.stress[e].topRows<6>()).cwiseAbs().maxCoeff(), 1e-13 * largest);
    EXPECT_NEAR(square, integrals.square[e], 1e-13 * largest * largest);
  }
}

/// Sums about another centre: the polynomials of the shifted coordinates.
TEST(CellSums, Shifted) {
  const CutCells cc = test::cut(Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.41, "sphere"), test::odd_grid(5, 0.3));
  const double d[3] = {0.4, -0.7, 1.2};
  const auto shifted = [&d](const double* stress, const double* moments) {
    CellSums x{}, y{}, z{};
    x.add<0>(stress, moments, 2.0, d[0]);
    y.add<1>(x, d[1]);
    z.add<2>(y, d[2]);
    return z;
  };
  const QuarticMoments nothing{};
  Eigen::Matrix<double, 10, 10> shift;  // of the terms
  for (int t = 0; t < 10; ++t) {
    PaddedPolynomial unit = PaddedPolynomial::Zero();
    unit.col(t).setOnes();
    const CellSums sums = shifted(unit.data(), nothing.data());
    EXPECT_EQ(sums.square, 2.0);
    for (int s = 0; s < 10; ++s) {
      shift(s, t) = sums.stress[s][0];
      for (int k = 1; k < 8; ++k) EXPECT_EQ(sums.stress[s][k], sums.stress[s][0]);
    }
  }
  for (int q = 0; q < 10; ++q) {
    Eigen::Matrix<double, 10, 1> here, there;
    const Vec3 x = Vec3::Random(), y = x + Vec3(d);
    Polynomial<2>::terms(x.data(), here.data());
    Polynomial<2>::terms(y.data(), there.data());
    EXPECT_LT((there - shift * here).norm(), 1e-14 * there.norm());
  }
  const PaddedPolynomial stress = PaddedPolynomial::Random();
  for (const Moments& cell : cc.moments) {
    const QuarticMoments moments = quartic_moments(cell);
    const QuadraticMass expected = shift * quadratic_mass(moments.data()) * shift.transpose();
    const CellSums sums = shifted(stress.data(), moments.data());
    EXPECT_LT((quadratic_mass(sums.moments) - expected).norm(), 1e-14 * expected.norm());
    const Eigen::Map<const PaddedPolynomial> moved(sums.stress[0]);
    EXPECT_LT((moved - stress * shift.transpose()).norm(), 1e-14 * moved.norm());
  }
}

}  // namespace
}  // namespace cgcontact::test_exact_stress
