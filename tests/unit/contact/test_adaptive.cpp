/// What a solution asks of the next grid: where a zone lies that its cells do not resolve, sizes from errors, a start
/// from another grid, errors from two grids.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "contact/adaptive/energy_sizes.hpp"
#include "contact/adaptive/first_grid.hpp"
#include "contact/adaptive/next_grid.hpp"
#include "contact/adaptive/two_grid_estimate.hpp"
#include "contact/adaptive_run.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_adaptive {
namespace {

/// The scene on its first grids.
struct FirstSolve {
  Scene scene;
  std::unique_ptr<Simulation> simulation;
  std::vector<ZoneState> zones;

  explicit FirstSolve(const std::vector<std::string>& overrides) {
    const Scene given = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/scenes/ball_on_plate.toml", overrides);
    scene = *scene_on_grids(given, first_sizes(given));
    simulation = std::make_unique<Simulation>(scene);
    simulation->run({});
    zones = zone_states(simulation->state, simulation->results);
  }
};

/// Radius of Hertz's contact circle, m.
double hertz_radius(double force) { return std::cbrt(3 * force * 10e-3 / (4 * 210e9 / (2 * (1 - 0.09)))); }

/// 2.7 cells over twice the volume over the free surface: of the plate (its lower face and two sides are held) the free
/// surface is the top and two sides, 3 (0.02 m)^2.
TEST(FirstGrid, ComesFromTheShape) {
  const Scene scene = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/scenes/ball_on_plate.toml", {});
  const std::vector<double> sizes = first_cell_sizes(scene);
  EXPECT_NEAR(sizes[0], 2 * std::pow(0.02, 3) / (3 * std::pow(0.02, 2)) / scene.accuracy.first_cells_through, 1e-9);
  EXPECT_EQ(first_cell_sizes(read_scene(scene.file, {"body.plate.cell_size=3e-3"}))[0], 3e-3);
}

/// Zones of a sixteenth and less of a cell of the plate: the overlap under the computed force is where the ball's
/// lowest point is, and about as wide as Hertz's circle (the law of the overlap's force holds within 6 %, the force of
/// a zone that small within 10 %, so the width within some 10 %).
TEST(SmallZonePositions, AreFoundBetweenTheQuadraturePoints) {
  for (const double force : {50.0, 0.5}) {
    const FirstSolve first({"F=" + std::to_string(force)});
    ASSERT_EQ(first.zones.size(), 1u);
    const ZoneState& zone = first.zones[0];
    ASSERT_TRUE(zone.narrowed);
    EXPECT_FALSE(zone.resolved);
    const double a = hertz_radius(force);
    EXPECT_NEAR(*zone.width / (2 * a), 1, 0.2) << "F = " << force;
    for (const SizedBall& ball : zone.balls) {
      EXPECT_LT(ball.center.head<2>().norm(), 2 * a);
      EXPECT_NEAR(ball.center[2], 0, 1e-9) << "on the plate, the primary body";
    }
  }
}

/// Equal errors in all cells: the cells change by one factor, E over the present error.
TEST(EnergySizes, OfEqualErrors) {
  const auto solved = test::run_scene("scenes/patch_test.toml");
  Results results;
  results.estimated_error = 0.2;
  results.estimated_error_relative = 0.1;
  std::size_t cells = 0;
  for (const BodyFields& body : solved->results().bodies) cells += body.error_of_cell.size();
  for (const BodyFields& body : solved->results().bodies) {
    BodyFields fields;
    fields.cut_cells = body.cut_cells;
    fields.error_of_cell.assign(body.error_of_cell.size(), 0.2 / std::sqrt(static_cast<double>(cells)));
    results.bodies.push_back(fields);
  }
  const auto balls = energy_sizes(results, 0.05, {1e9, 1e9});
  const double up_to_halvings = 1.41;
  for (std::size_t b = 0; b < balls.size(); ++b) {
    EXPECT_EQ(balls[b].size(), results.bodies[b].error_of_cell.size());
    for (std::size_t c = 0; c < balls[b].size(); ++c)
      EXPECT_NEAR(balls[b][c].size, up_to_halvings * 0.5 * results.bodies[b].cut_cells->h(static_cast<int>(c)), 1e-9);
  }
}

/// Each solve of a run begins with the zone of the one before: fewer outer iterations than from nothing, and the same
/// solution to the tolerance of the outer iteration (1e-6; forces of the last solve are in equilibrium to 1e-8).
TEST(OuterStart, SameSolutionInFewerIterations) {
  const Scene given = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/scenes/wheel_on_rail.toml",
                                 {"accuracy.pressure=1%", "accuracy.max_solves=3"});
  AdaptiveRun run(given);
  run.run({});
  const AccuracyFigures& figures = run.simulation().results.accuracy;
  ASSERT_GE(figures.solves.size(), 3u);
  ASSERT_TRUE(figures.solves[1].pressure) << "the zone must be resolved before the last solve";
  Simulation cold(run.scene());
  cold.run({});
  EXPECT_LT(run.simulation().results.outer_iterations, cold.results.outer_iterations);
  EXPECT_EQ(run.simulation().results.active_points, cold.results.active_points);
  EXPECT_NEAR(run.simulation().results.pairs[0].max_pressure / cold.results.pairs[0].max_pressure, 1, 1e-5);
}

/// Against the same solution the change is zero: the estimate is that of one solution with its factors.
TEST(TwoGridEstimate, OfOneSolutionTwice) {
  FirstSolve first({"body.plate.cell_size=0.9e-3", "body.ball.cell_size=0.8e-3", "F=4e5"});
  Simulation& simulation = *first.simulation;
  ASSERT_TRUE(first.zones[0].resolved);
  const double before = simulation.results.pairs[0].pressure_error_estimate;
  EarlierSolution earlier{&simulation.state, {first.zones[0].cell}};
  const auto change = estimate_from_two_grids(first.zones, earlier, first.scene.accuracy, simulation.results);
  ASSERT_TRUE(change);
  EXPECT_LT(*change, 1e-9);
  const double across = *first.zones[0].width / first.zones[0].cell;
  EXPECT_NEAR(simulation.results.pairs[0].pressure_error_estimate / before,
              first.scene.accuracy.safety * (1 + std::pow(first.scene.accuracy.doubtful_width / across, 2)), 1e-9);
}

/// A rigid cylinder of radius a, pressed with its flat end into an elastic one of radius and height 20 a. The pressure
/// has no finite value at the rim, the force has: 238.3 N (finite elements of four corners graded down to a/500 at the
/// rim; 2 a E* d of a half-space is 230.8 N). The cells that the force's error asks of the elastic body at the rim are
/// asked of the rigid one as well: with its first cells there the force was 1 % off, estimated to 0.05 %.
TEST(ForceOfASharpPunch, IsAsAccurateAsAsked) {
  for (const char* grid : {"", "grid = {offset = [0, 0, 0.37]}\n"})
    for (const double target : {0.05, 0.01}) {
      const Scene scene = parse_scene(std::string(R"(
axisymmetric = "z"
[[body]]
name = "block"
material = {E = 210e9, nu = 0.3}
shape = {name = "block", cylinder = {base = [0, 0, -0.1], top = [0, 0, 0], radius = 0.1}}
)") + grid + R"(
[[body]]
name = "punch"
rigid = true
shape = {name = "punch", cylinder = {base = [0, 0, 0], top = [0, 0, 0.005], radius = 0.005}}
[[support]]
face = "block.block.bottom"
displacement = {z = 0}
[[support]]
face = "punch.punch.top"
displacement = {z = -1e-7}
[[contact]]
faces = ["block.block.top", "punch.punch.bottom"]
[accuracy]
force = )" + std::to_string(target) + "\n",
                                      "punch.toml");
      AdaptiveRun run(scene);
      run.run({});
      const Results& results = run.simulation().results;
      const double error = results.pairs[0].force_on_first.norm() / 238.3 - 1;
      const std::optional<double> estimate = results.pairs[0].force_error_estimate;
      ASSERT_TRUE(estimate);
      std::printf("asked %g, estimated %.4f, off by %.4f\n", target, *estimate, error);
      EXPECT_LT(*estimate, target);
      EXPECT_LT(std::abs(error), *estimate);
    }
}

/// An error that is no number is worse than any: not reached, whichever figure it is of and whichever pair it comes
/// with.
TEST(ErrorFigures, WhatIsNoNumberIsNotReached) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Scene scene;
  scene.accuracy.pressure = scene.accuracy.force = scene.accuracy.stress = 0.5;
  std::vector<ZoneState> zones(2);
  for (ZoneState& zone : zones) zone.relevant = zone.resolved = true;
  Results good;
  good.pairs.resize(2);
  good.verdict.pairs.resize(2);
  for (PairFigures& pair : good.pairs) {
    pair.pressure_error_estimate = 0.1;
    pair.force_error_estimate = 0.1;
  }
  good.estimated_error_relative = 0.1;
  EXPECT_TRUE(error_figures(scene, zones, good).met);
  EXPECT_TRUE(error_figures(scene, zones, good).finite);
  for (int which = 0; which < 5; ++which) {
    Results results = good;
    if (which < 2) results.pairs[which].pressure_error_estimate = nan;
    if (which == 2 || which == 3) results.pairs[which - 2].force_error_estimate = nan;
    if (which == 4) results.estimated_error_relative = nan;
    EXPECT_FALSE(error_figures(scene, zones, results).met) << which;
    EXPECT_FALSE(error_figures(scene, zones, results).finite) << which;
  }
}

}  // namespace
}  // namespace cgcontact::test_adaptive
