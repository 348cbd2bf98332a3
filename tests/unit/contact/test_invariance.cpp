/// What must not change the answer: running again, the user's units, the order of the bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kernels/solver/linear_solver.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_invariance {
namespace {

const std::string scene = "tests/scenes/units.toml";

/// Bit for bit on the serial backend. With several threads sums are in another order each time (the random start of the
/// eigenvalue estimates as well), so only rounding and what the solver makes of it may differ.
TEST(Invariance, RunsAreReproducible) {
  const auto a = test::run_scene(scene), b = test::run_scene(scene);
  const RealView &u = a->simulation->state.outer.u, &v = b->simulation->state.outer.u;
  ASSERT_EQ(u.extent(0), v.extent(0));
  double largest = 0;
  for (std::size_t i = 0; i < u.extent(0); ++i) largest = std::max(largest, std::abs(u(i)));
  const double relative = TrilinosScope::has_openmp() ? 1e-10 : 0;
  for (std::size_t i = 0; i < u.extent(0); ++i) ASSERT_NEAR(u(i), v(i), relative * largest);
  for (std::size_t r = 0; r < a->results().contact_rows.size(); ++r)
    ASSERT_NEAR(a->results().contact_rows[r].pressure_sprc, b->results().contact_rows[r].pressure_sprc,
                relative * a->results().pairs[0].max_pressure);
}

/// Lengths in mm and stresses in MPa: only rounding differs, so converged solutions agree to the linear tolerance.
TEST(Invariance, UnitsOnlyScaleTheAnswer) {
  const std::vector<std::string> tight{"solver.tolerance=1e-12", "solver.linear_tolerance=1e-13"};
  const auto si = test::run_scene(scene, tight);
  std::vector<std::string> scaled = tight;
  scaled.insert(scaled.end(), {"L=1e3", "S=1e-6"});
  const auto mm = test::run_scene(scene, scaled);
  ASSERT_TRUE(si->results().converged) << si->results().diagnosis;
  ASSERT_TRUE(mm->results().converged) << mm->results().diagnosis;
  EXPECT_EQ(si->results().outer_iterations, mm->results().outer_iterations);
  const auto &a = si->results().contact_rows, &b = mm->results().contact_rows;
  ASSERT_EQ(a.size(), b.size());
  const double scale = si->results().pairs[0].max_pressure;
  int open = 0;
  for (std::size_t r = 0; r < a.size(); ++r) {
    EXPECT_NEAR(a[r].pressure_raw / scale, b[r].pressure_raw / scale * 1e6, 1e-10);
    EXPECT_NEAR(a[r].pressure_spr / scale, b[r].pressure_spr / scale * 1e6, 1e-10);
    EXPECT_NEAR(a[r].pressure_sprc / scale, b[r].pressure_sprc / scale * 1e6, 1e-10);
    EXPECT_EQ(a[r].active, b[r].active);
    open += !a[r].active;
  }
  EXPECT_GT(open, 0);  // partial contact, otherwise the case proves little
  EXPECT_NEAR(mm->results().estimated_error_relative / si->results().estimated_error_relative, 1, 1e-10);
}

/// With equal cell sizes the names decide which body is primary: the order of the faces does not matter.
TEST(Invariance, SwappingTheFacesChangesNothing) {
  const std::vector<std::string> equal{"body.upper.cell_size=0.125", "solver.tolerance=1e-12",
                                       "solver.linear_tolerance=1e-13"};
  std::vector<std::string> swapped = equal;
  swapped.push_back("contact.0.faces=[\"upper.z-\", \"lower.z+\"]");
  const auto a = test::run_scene(scene, equal), b = test::run_scene(scene, swapped);
  const double force = a->results().pairs[0].force_on_first.norm();
  EXPECT_NEAR(a->results().pairs[0].force_on_first[2] / force, b->results().pairs[0].force_on_second[2] / force, 1e-10);
  double difference = 0, norm = 0;
  ASSERT_EQ(a->results().contact_rows.size(), b->results().contact_rows.size());
  for (std::size_t r = 0; r < a->results().contact_rows.size(); ++r) {
    const ContactRow &p = a->results().contact_rows[r], &q = b->results().contact_rows[r];
    difference += p.weight * std::pow(p.pressure_sprc - q.pressure_sprc, 2);
    norm += p.weight * std::pow(p.pressure_sprc, 2);
  }
  EXPECT_LT(std::sqrt(difference / norm), 1e-9);
}

/// Bodies and grids turned together: the same discrete problem, so the same answer up to rounding.
TEST(Invariance, TurningTheSceneChangesNothing) {
  const std::vector<std::string> tight{"solver.tolerance=1e-12", "solver.linear_tolerance=1e-13"};
  std::vector<std::string> turned = tight;
  turned.insert(turned.end(), {"angle=40", "grid_angle=40"});
  const auto a = test::run_scene("tests/scenes/turned.toml", tight);
  const auto b = test::run_scene("tests/scenes/turned.toml", turned);
  const Results &ra = a->results(), &rb = b->results();
  ASSERT_TRUE(ra.converged && rb.converged) << ra.diagnosis << rb.diagnosis;
  ASSERT_EQ(ra.contact_rows.size(), rb.contact_rows.size());
  const double scale = ra.pairs[0].max_pressure;
  EXPECT_NEAR(rb.pairs[0].max_pressure / scale, 1, 1e-8);
  EXPECT_NEAR(rb.pairs[0].force_on_first.norm() / ra.pairs[0].force_on_first.norm(), 1, 1e-8);
  EXPECT_NEAR(rb.estimated_error / ra.estimated_error, 1, 1e-8);
  int open = 0;
  for (const ContactRow& row : ra.contact_rows) open += !row.active;
  EXPECT_GT(open, 0);
}

/// Bodies turned against their grids: another discretisation of the same problem, the same force within its error.
TEST(Invariance, TurningTheBodiesAgainstTheirGridsChangesLittle) {
  const auto a = test::run_scene("tests/scenes/turned.toml");
  const double force = a->results().pairs[0].force_on_first.norm();
  for (const char* angle : {"angle=1e-10", "angle=17", "angle=63"}) {
    const auto b = test::run_scene("tests/scenes/turned.toml", {angle});
    ASSERT_TRUE(b->results().converged) << angle << ": " << b->results().diagnosis;
    EXPECT_NEAR(b->results().pairs[0].force_on_first.norm() / force, 1, 0.02) << angle;
    EXPECT_NEAR(b->results().pairs[0].area / a->results().pairs[0].area, 1, 0.2) << angle;
  }
}

TEST(OneBody, RunsThroughTheSamePathWithoutContact) {
  const auto solved = test::run_scene("tests/scenes/one_body.toml", {"solver.tolerance=1e-12"});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  EXPECT_TRUE(r.pairs.empty());
  EXPECT_TRUE(r.contact_rows.empty());
  // Uniaxial tension is linear: exact.
  const BodyFields& body = r.bodies[0];
  for (int c = 0; c < static_cast<int>(body.cut_cells->cells.size()); ++c) {
    Sym3 exact = Sym3::Zero();
    exact[0] = 2e6;
    EXPECT_LT((body.stress_recovered(c, Vec3(0.3, -0.2, 0.1)) - exact).norm(), 1e-9 * 2e6);
  }
}

/// A bar under its own weight, fixed on top: sigma_zz = rho g (z - 0) is linear, SPR-C reproduces it.
TEST(OneBody, BodyForceIsInEquilibriumInTheRecoveredStress) {
  const auto solved = test::run_scene("tests/scenes/hanging_bar.toml", {"solver.tolerance=1e-10"});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const BodyFields& body = r.bodies[0];
  double error = 0, norm = 0;
  for (int c = 0; c < static_cast<int>(body.cut_cells->cells.size()); ++c) {
    const Index3& g = body.cut_cells->cells[c];
    const double z = body.cut_cells->grid.to_global(Vec3(g[0] + 0.5, g[1] + 0.5, g[2] + 0.5))[2];
    const double exact = 78000 * z;
    error += std::pow(body.stress_recovered(c, Vec3::Zero())[2] - exact, 2);
    norm += exact * exact;
  }
  EXPECT_LT(std::sqrt(error / norm), 0.01);
}

}  // namespace
}  // namespace cgcontact::test_invariance
