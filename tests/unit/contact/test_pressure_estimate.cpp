/// The estimated errors of contact pressure and force against the true ones (docs/recovery.md, "Error figures").
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/support/run_scene.hpp"

namespace cgcontact::test_pressure_estimate {
namespace {

struct EstimateCase {
  const char* scene;
  std::vector<std::string> overrides;
  double factor;  ///< estimated over true error of the pressure: between 1 / factor and factor
};

void PrintTo(const EstimateCase& c, std::ostream* out) {
  *out << c.scene;
  for (const std::string& override : c.overrides) *out << " " << override;
}

class PressureEstimate : public testing::TestWithParam<EstimateCase> {};

TEST_P(PressureEstimate, IsNearTheTrueError) {
  const EstimateCase& c = GetParam();
  const auto solved = test::run_scene(c.scene, c.overrides);
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const double ratio = r.pairs[0].pressure_error_estimate / test::zone(r, "whole").sprc;
  std::printf("estimated / true error of the pressure: %.3f\n", ratio);
  EXPECT_LE(ratio, c.factor);
  EXPECT_GE(ratio, 1 / c.factor);
  for (const ContactRow& row : r.contact_rows)
    ASSERT_TRUE(std::isfinite(row.pressure_error) && row.pressure_error >= 0) << row.x.transpose();
}

// The error of two_solids n = 32 at this position, 0.09 %, is a quarter of the mean of eight.
// Without an edge 1.25 is what is promised for degree 1. With an edge 28 runs gave 0.6 to 2.9, most 0.7 to 1.6: what is
// left is the scatter of the edge's position, one figure per edge, which no figure of the same solution tells.
INSTANTIATE_TEST_SUITE_P(
    Scenes, PressureEstimate,
    testing::Values(
        EstimateCase{"scenes/rings.toml", {"n=8"}, 1.25}, EstimateCase{"scenes/rings.toml", {"n=16"}, 1.25},
        EstimateCase{"scenes/rings.toml", {"n=32"}, 1.25},
        EstimateCase{"scenes/rings.toml", {"n=16", "body.0.grid.offset=[0.1, 0.77, 0.11]"}, 1.25},
        EstimateCase{"scenes/sphere_in_shell.toml", {"n=8"}, 1.25},
        EstimateCase{"scenes/sphere_in_shell.toml", {"n=8", "body.0.grid.offset=[0.9, 0.05, 0.6]", "angle=50"}, 1.25},
        EstimateCase{"scenes/two_solids.toml", {"n=8"}, 2}, EstimateCase{"scenes/two_solids.toml", {"n=16"}, 2},
        EstimateCase{"scenes/two_solids.toml", {"n=32"}, 3}));

// Under interference alone the force is twice the energy over the interference, so that its relative error is the
// square of that of the energy norm (Galerkin), and the estimate as good as the square of the effectivity: 1.15^2
// = 1.32 at n = 8, 1.02^2 at n = 16. Measured: 1.43 and 1.15; what is left is as large as at n = 32 (1.12).
TEST(ForceEstimate, IsTheErrorOfTheForceOfAShrinkFit) {
  for (const char* n : {"n=8", "n=16"}) {
    const auto solved = test::run_scene("scenes/sphere_in_shell.toml", {n});
    const PairFigures& pair = solved->results().pairs[0];
    const double exact = *solved->scene.reference.force;
    const double ratio = *pair.force_error_estimate / std::abs(pair.force_on_first.norm() / exact - 1);
    EXPECT_GE(ratio, 1.0) << n;
    EXPECT_LE(ratio, 1.6) << n;
  }
}

// The paper's scene is loaded as well: there the estimate is a bound, 1.0 to 32 times the error in 11 runs.
TEST(ForceEstimate, BoundsTheErrorOfTheForceUnderLoads) {
  for (const char* n : {"n=16", "n=32"}) {
    const auto solved = test::run_scene("scenes/two_solids.toml", {n});
    const PairFigures& pair = solved->results().pairs[0];
    EXPECT_LE(std::abs(pair.force_on_first.norm() / *solved->scene.reference.force - 1), *pair.force_error_estimate);
  }
}

/// Two blocks of length 1 and area 1 between walls that overlap by 1e-4; nu = 0, so that all is linear.
const char* const blocks = R"(
[[body]]
name = "low"
shape = {box = {min = [0, 0, 0], max = [1, 1, 1]}}
material = {E = 1e9, nu = 0}
cell_size = 0.13
grid = {offset = [0.2, 0.3, 0.6]}
[[body]]
name = "up"
shape = {box = {min = [0, 0, 1], max = [1, 1, 2]}}
material = {E = 1e9, nu = 0}
cell_size = 0.11
grid = {offset = [0.7, 0.1, 0.4]}
[[support]]
face = "low.z-"
displacement = {x = 0, y = 0, z = 0}
[[support]]
face = "up.z+"
displacement = {x = 0, y = 0, z = 0}
[[contact]]
faces = ["low.z+", "up.z-"]
interference = 1e-4
)";

// A bar of length 2: E A / 2. Supports and contact give way by h / (kappa E) each, less than a tenth of it.
TEST(ForceEstimate, ApproachOfTwoBlocksIsThatOfABar) {
  const auto solved = test::run_text(blocks);
  const std::vector<Approach>& approaches = solved->simulation->state.approaches;
  ASSERT_EQ(approaches.size(), 1u);
  EXPECT_LE(approaches[0].stiffness, 0.5e9);
  EXPECT_GE(approaches[0].stiffness, 0.45e9);
  const Scales& scales = solved->simulation->state.scales;
  const double energy = approaches[0].stiffness / (scales.stress * scales.length);
  double error = 0;
  for (const std::vector<double>& body : approaches[0].error_of_cell)
    error += std::accumulate(body.begin(), body.end(), 0.0);
  EXPECT_LT(error, 1e-3 * energy);  // the tolerance of its linear solve is 1e-2 of the forces
}

TEST(ForceEstimate, NoApproachWhereTheLoadsGiveTheForce) {
  const auto solved =
      test::run_text(blocks, {"support.1.displacement={x = 0, y = 0}", "load=[{face = \"up.z+\", pressure = 1e5}]"});
  EXPECT_TRUE(solved->simulation->state.approaches.empty());
  EXPECT_EQ(solved->results().pairs[0].force_error_estimate, 0.0);
}

}  // namespace
}  // namespace cgcontact::test_pressure_estimate
