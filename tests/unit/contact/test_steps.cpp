/// Loads in steps: frictionless contact at small strain does not depend on the path, so every step is what a run with
/// its loads alone gives.
#include <gtest/gtest.h>

#include "tests/support/run_scene.hpp"

namespace cgcontact::test_steps {
namespace {

/// Step k and a run of its own, both solved to the outer tolerance of 1e-9: figures agree to a hundred times that (the
/// contact area is counted in whole points of the face).
void expect_step(const StepFigures& step, const Results& alone, std::size_t pairs) {
  ASSERT_TRUE(step.converged);
  ASSERT_EQ(step.pairs.size(), pairs);
  for (std::size_t p = 0; p < pairs; ++p) {
    const PairFigures &a = step.pairs[p], &b = alone.pairs[p];
    EXPECT_LT((a.force_on_first - b.force_on_first).norm(), 1e-7 * b.force_on_first.norm());
    EXPECT_NEAR(a.max_pressure / b.max_pressure, 1, 1e-7);
    EXPECT_NEAR(a.area / b.area, 1, 1e-7);
    EXPECT_EQ(a.active_points, b.active_points);
  }
}

/// Loads and prescribed displacements together; the contact zone changes with the step.
TEST(StepsOfLoad, AreRunsOfTheirOwn) {
  const std::vector<std::string> tight = {"n=8", "solver.tolerance=1e-9", "solver.linear_tolerance=1e-12"};
  auto overrides = tight;
  overrides.push_back("steps.displacements=[1, 0.5, 1]");
  overrides.push_back("steps.loads=[0.2, 0.5, 1]");
  const auto solved = test::run_scene("scenes/two_solids.toml", overrides);
  const Results& r = solved->results();
  ASSERT_EQ(r.steps.size(), 3u);
  const auto final = test::run_scene("scenes/two_solids.toml", tight);
  expect_step(r.steps[2], final->results(), 1);
  EXPECT_NEAR(test::zone(r, "whole").sprc / test::zone(final->results(), "whole").sprc, 1, 1e-4);
  Scene scene = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/scenes/two_solids.toml", tight);
  const std::string half[] = {"load.0.pressure=0.5*4e11*(0.01-z)*z",
                              "load.0.traction=[0, 0, \"-0.5*10e11*(0.01-z)*z\"]"};
  overrides = tight;
  overrides.insert(overrides.end(), half, half + 2);
  for (std::size_t s = 0; s < scene.supports.size(); ++s)
    if (scene.supports[s].displacement[2] && !scene.supports[s].displacement[2]->is_zero())
      overrides.push_back("support." + std::to_string(s) + ".displacement={z = -0.8e-6}");
  expect_step(r.steps[1], test::run_scene("scenes/two_solids.toml", overrides)->results(), 1);
  EXPECT_NE(r.steps[0].pairs[0].active_points, r.steps[1].pairs[0].active_points) << "the case proves nothing";
}

TEST(StepsOfInterference, AreRunsOfTheirOwn) {
  const std::vector<std::string> tight = {"n=8", "solver.tolerance=1e-9", "solver.linear_tolerance=1e-12"};
  auto overrides = tight;
  overrides.push_back("steps.factors=[0.25, 1]");
  const auto solved = test::run_scene("scenes/rings.toml", overrides);
  overrides = tight;
  overrides.push_back("delta=0.25e-4");
  expect_step(solved->results().steps.at(0), test::run_scene("scenes/rings.toml", overrides)->results(), 1);
}

/// A first step without any load: nothing happens, and the next ones start from there.
TEST(Steps, MayStartWithNothing) {
  const auto solved = test::run_scene("tests/scenes/gap.toml", {"steps.factors=[0, 0.5, 1]"});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  EXPECT_LT(r.steps[0].pairs[0].force_on_first.norm(), 1e-6 * 0.8e9);
  EXPECT_NEAR(r.steps[1].pairs[0].force_on_first[2] / (-0.4e9), 1, 1e-5);
  EXPECT_NEAR(r.steps[2].pairs[0].force_on_first[2] / (-0.8e9), 1, 1e-5);
}

/// A step that has no solution is named; the others are solved.
TEST(Steps, OneThatFailsIsNamed) {
  const auto solved = test::run_scene("tests/scenes/gap.toml", {"p=-1e9", "steps.loads=[0, 1]"});
  const Results& r = solved->results();
  EXPECT_FALSE(r.converged);
  EXPECT_NE(r.diagnosis.find("step 2 of 2: all contact has opened"), std::string::npos) << r.diagnosis;
  EXPECT_TRUE(r.steps[0].converged);
  EXPECT_FALSE(r.steps[1].converged);
}

}  // namespace
}  // namespace cgcontact::test_steps
