/// Bodies that are heated: free ones expand without stress, held ones have the stresses that are known.
#include <gtest/gtest.h>

#include "tests/support/run_scene.hpp"

namespace cgcontact::test_temperature {
namespace {

constexpr double E = 200e9, nu = 0.3, alpha = 12e-6, dT = 80;

/// A block of 0.5 x 0.4 x 1 m, heated, on a turned grid, with symmetry planes at x = 0, y = 0 and z = 0.
std::string block(const std::string& top = "", const std::string& keys = "") {
  return top + R"(
[[body]]
name = "block"
shape = {box = {min = [0, 0, 0], max = [0.5, 0.4, 1]}}
material = {E = 200e9, nu = 0.3, expansion = 12e-6}
cell_size = 0.13
temperature = 80
)" + keys +
         R"(
[[support]]
face = "block.x-"
symmetry = true
[[support]]
face = "block.y-"
symmetry = true
[[support]]
face = "block.z-"
symmetry = true
)";
}

/// A stress (Pa) and a displacement gradient everywhere, up to a fraction of E alpha dT, and of alpha dT times 1 m.
void expect(const Results& r, const Sym3& stress, const Mat3& gradient, double tolerance) {
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const test::Differences found = test::differences(
      r, [&](const Vec3&) { return stress; }, [&](const Vec3& x) { return Vec3(gradient * x); });
  EXPECT_LT(std::max(found.raw, found.recovered), tolerance * E * alpha * dT);
  EXPECT_LT(found.displacement, tolerance * alpha * dT);
}

const std::string turned = "grid = {offset = [0.3, 0.6, 0.2], rotation = {axis = [1, 2, 3], angle = 20}}\n";

TEST(Temperature, AFreeBodyExpandsWithoutStress) {
  const auto solved = test::run_text(block("", turned), test::tight_without_forces);
  expect(solved->results(), Sym3::Zero(), alpha * dT * Mat3::Identity(), 1e-10);
  EXPECT_LT(solved->results().estimated_error_relative, 1e-6) << "rounding is no error";
  for (const SupportFigures& support : solved->results().supports)
    EXPECT_LT(support.force.norm(), 1e-10 * E * alpha * dT * support.area) << support.face;
  ASSERT_EQ(solved->results().loads.size(), 1u);
  EXPECT_EQ(solved->results().loads[0].condition, "temperature +80 K, free strain 0.00096");
  EXPECT_EQ(solved->results().loads[0].force, Vec3(0, 0, 0));
}

TEST(Temperature, AFreeBodyOfSeveralCellSizesExpandsWithoutStress) {
  const auto solved =
      test::run_text(block("", turned + "refine = [{sphere = {center = [0, 0, 0], radius = 0.1}, size = 0.04}]\n"),
                     test::tight_without_forces);
  EXPECT_GT(solved->simulation->state.bodies[0].cut_cells.num_levels(), 1);
  expect(solved->results(), Sym3::Zero(), alpha * dT * Mat3::Identity(), 1e-10);
}

/// Held at both ends: sigma_zz = -E alpha dT, the sides expand by (1 + nu) alpha dT.
TEST(Temperature, AHeldBarIsPressed) {
  const std::string held = "[[support]]\nface = \"block.z+\"\nsymmetry = true\n";
  const auto solved = test::run_text(block("", turned) + held);
  const Sym3 stress = -E * alpha * dT * Sym3::Unit(2);
  expect(solved->results(), stress, (1 + nu) * alpha * dT * Vec3(1, 1, 0).asDiagonal().toDenseMatrix(), 1e-10);
  EXPECT_NEAR(solved->results().supports[3].force[2] / (-E * alpha * dT * 0.2), 1, 1e-10);
  EXPECT_LT(solved->results().estimated_error_relative, 1e-10);
}

/// Heated in two steps: half of it is half of the stress; the factor is that of the loads.
TEST(Temperature, GrowsWithTheLoadsOfSteps) {
  const std::string held = "[[support]]\nface = \"block.z+\"\nsymmetry = true\n[steps]\nloads = [0.5, 1]\n";
  const auto solved = test::run_text(block("", turned) + held);
  expect(solved->results(), -E * alpha * dT * Sym3::Unit(2),
         (1 + nu) * alpha * dT * Vec3(1, 1, 0).asDiagonal().toDenseMatrix(), 1e-10);
}

/// Nothing moves along the axis: the ends press with E alpha dT, on uniform grids and on quadtrees.
TEST(Temperature, PlaneStrainHoldsBackOneDirection) {
  for (const bool quadtree : {false, true}) {
    std::string text = block("plane_strain = \"z\"\n", quadtree ? "refine = [{face = \"y+\", size = 0.04}]\n" : "");
    text.erase(text.find("[[support]]\nface = \"block.z-\""));
    text.replace(text.find("0.4, 1]"), 7, "0.4, 0.1]");
    const auto solved = test::run_text(text, test::tight_without_forces);
    expect(solved->results(), -E * alpha * dT * Sym3::Unit(2),
           (1 + nu) * alpha * dT * Vec3(1, 1, 0).asDiagonal().toDenseMatrix(), 1e-10);
    const SupportFigures& end = solved->results().supports[3];
    EXPECT_NEAR(std::abs(end.force[2]) / (E * alpha * dT * 0.2), 1, 1e-10) << end.face;
  }
}

/// Two steel rings, the outer one cold: Lame's solution of plane stress with an interference of alpha dT b, to which
/// the free ends are exact. Measured at n = 8, 16: 0.025, 0.0080 (SPR 0.12, 0.067), effectivity 1.11, 1.02.
TEST(Temperature, ShrinksARingOnARing) {
  double error[2];
  int k = 0;
  for (const char* n : {"n=8", "n=16"}) {
    const auto solved = test::run_scene("scenes/shrink_fit_heated.toml", {n});
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    error[k++] = test::zone(r, "whole").sprc;
    ASSERT_TRUE(r.has_effectivity);
    EXPECT_NEAR(r.effectivity, 1, k == 1 ? 0.15 : 0.05);
    for (const BodyBalance& balance : r.balance)
      EXPECT_LT((balance.loads + balance.supports + balance.contact).norm(), 1e-6 * balance.contact.norm());
  }
  EXPECT_LT(error[0], 0.03);
  EXPECT_LT(error[1], 0.01);
}

/// The same pressure as by an interference of alpha dT b: both are the same gaps, up to the outer tolerance, 1e-6.
TEST(Temperature, ShrinksLikeAnInterference) {
  const auto heated = test::run_scene("scenes/shrink_fit_heated.toml", {"n=8"});
  const auto pressed = test::run_scene("scenes/shrink_fit_heated.toml",
                                       {"n=8", "body.1.temperature=0", "contact.0.interference=alpha*dT*b"});
  const auto &a = heated->results().contact_rows, &b = pressed->results().contact_rows;
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t r = 0; r < a.size(); ++r)
    EXPECT_NEAR(a[r].pressure_sprc, b[r].pressure_sprc, 1e-6 * pressed->results().pairs[0].max_pressure);
}

}  // namespace
}  // namespace cgcontact::test_temperature
