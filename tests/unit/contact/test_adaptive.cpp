/// What a solution asks of the next grid: where a zone lies that its cells do not resolve, sizes from errors, a start
/// from another grid, errors from two grids.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "contact/adaptive/displacement_error.hpp"
#include "contact/adaptive/energy_sizes.hpp"
#include "contact/adaptive/first_grid.hpp"
#include "contact/adaptive/next_grid.hpp"
#include "contact/adaptive/singular_points.hpp"
#include "contact/adaptive/two_grid_estimate.hpp"
#include "contact/adaptive/zone_sizes.hpp"
#include "contact/adaptive_run.hpp"
#include "tests/support/run_scene.hpp"
#include "tests/support/scene_text.hpp"

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

/// The sizes of closed groups reach the target, as errors fall with the size, with the fewest cells: by Lagrange's rule
/// a little more error saves as many cells everywhere, so that error^2 ratio^4 is the same in all groups (cells on a
/// face go with 1 / ratio^2, squared errors with ratio^2).
TEST(ZoneSizes, ReachTheTargetWithTheFewestCells) {
  const Scene scene = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/tests/scenes/gap.toml", {});
  Simulation simulation(scene);
  simulation.set_up_grids();
  const ContactPair& pair = simulation.state.pairs[0];
  const double target = 0.1, p = 1e6;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.5, 2);
  Results results;
  ZoneState zone;
  std::vector<double> squared;  // errors of the groups
  double norm = 0;
  for (const ContactGroup& group : pair.groups) {
    ContactRow row;
    row.body = group.body;
    row.cell = group.cell;
    row.weight = group.area;
    row.pressure_sprc = p;
    const double share =
        0.8 / static_cast<double>(pair.groups.size());  // of the face: the sizes stay within their limits
    squared.push_back(uniform(random) * target * target * p * p * share);
    row.pressure_error = std::sqrt(squared.back() / group.area);
    norm += row.weight * p * p;
    results.contact_rows.push_back(row);
    zone.balls.push_back({centre_of(pair, group), 0.1, 0.3});
  }
  EXPECT_NEAR(norm, 0.8 * p * p, 1e-9 * p * p);
  size_by_error(simulation.state, results, 0, target, zone);
  double sum = 0;
  for (std::size_t g = 0; g < squared.size(); ++g) {
    const double ratio = zone.balls[g].size / 0.3;
    ASSERT_GT(ratio, 0.5);
    ASSERT_LT(ratio, 1.9);
    sum += squared[g] * ratio * ratio;
    EXPECT_NEAR(squared[g] * std::pow(ratio, 4) / (squared[0] * std::pow(zone.balls[0].size / 0.3, 4)), 1, 1e-9);
  }
  EXPECT_NEAR(std::sqrt(sum / norm) / target, 1, 1e-9);
}

/// The middle of groups, weighted by their area, is that of the face.
TEST(ZoneSizes, CentresOfGroupsMakeUpThatOfTheFace) {
  const Scene scene = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/tests/scenes/gap.toml", {});
  Simulation simulation(scene);
  simulation.set_up_grids();
  ContactPair& pair = simulation.state.pairs[0];
  Vec3 sum = Vec3::Zero();
  for (const ContactGroup& group : pair.groups) sum += group.area / 0.8 * centre_of(pair, group);
  EXPECT_LT((sum - Vec3(0.5, 0.4, 0.6)).norm(), 1e-12);
  for (std::size_t q = 0; q < pair.points.size(); ++q) pair.points.set_active(q, false);
  const ContactGroup& last = pair.groups.back();
  pair.points.set_active(last.last_point - 1, true);
  for (const ContactGroup& group : pair.groups) EXPECT_EQ(is_closed(pair, group), &group == &last);
}

/// A resolved zone whose error misses the target gets cells with which it is `aim` of that; one that is not resolved
/// gets `middle_cells` over half its width, counted one cell too wide at most.
TEST(ZoneSizes, OfTheNextGridFollowErrorOrWidth) {
  const AccuracyOptions options;
  ZoneState zone;
  zone.cell = 0.1;
  EXPECT_EQ(next_size_ratio(zone, 0.5, 0.01, options), 1) << "it does not matter";
  zone.relevant = zone.resolved = true;
  zone.error = 0.05;
  EXPECT_EQ(next_size_ratio(zone, 0.05, {}, options), 1) << "nothing is asked";
  EXPECT_EQ(next_size_ratio(zone, 0.05, 0.06, options), 1);
  const double ratio = next_size_ratio(zone, 0.05, 0.02, options);
  EXPECT_NEAR(zone.error * std::pow(ratio, options.rate), options.aim * 0.02, 1e-12);
  EXPECT_EQ(next_size_ratio(zone, 0.05, 1e-9, options), 1 / options.max_change);
  EXPECT_EQ(next_size_ratio(zone, 0.05, 0.0499, options), 1 / options.min_change);
  zone.resolved = false;
  EXPECT_EQ(next_size_ratio(zone, 0.05, {}, options), 1 / options.max_change);
  zone.width = 0.2;
  zone.narrowed = true;
  EXPECT_NEAR(0.5 * 0.2 / (0.1 * next_size_ratio(zone, 0.05, {}, options)), options.middle_cells, 1e-12);
  zone.narrowed = false;
  EXPECT_NEAR(0.5 * 0.3 / (0.1 * next_size_ratio(zone, 0.05, {}, options)), options.middle_cells, 1e-12);
  zone.width.reset();
  zone.needed = 0.1 / 20;
  EXPECT_NEAR(next_size_ratio(zone, 0.05, {}, options), 0.05, 1e-15);
}

/// Twice the square of the energy norm's error; against a solve with twice that error, whose own is four times as
/// large, a third of the change. Where errors hardly fall the change counts three times. What holdings take is added.
TEST(DisplacementErrors, FollowTheEnergyNormAndTheChange) {
  const DisplacementState none, before{{Vec3(0, 0.7, 0), Vec3(0, 0, 1), Vec3::Zero()}, 0.2},
      now{{Vec3(0, 1, 0), Vec3(0, 0, 1.001), Vec3::Zero()}, 0.1}, no_better{before.values, 0.1};
  const std::vector<double> alone = displacement_errors(now, none), compared = displacement_errors(now, before);
  for (const double error : alone) EXPECT_NEAR(error, 0.02, 1e-15);
  ASSERT_EQ(compared.size(), 3u);
  EXPECT_NEAR(compared[0], 0.1, 1e-15);
  EXPECT_NEAR(compared[1], 0.02, 1e-15) << "the change is less";
  EXPECT_NEAR(compared[2], 0.02, 1e-15) << "no displacement has no relative change";
  EXPECT_NEAR(displacement_errors(now, no_better)[0], 0.9, 1e-14);
  DisplacementState held = now;
  held.held = 0.023;
  EXPECT_NEAR(displacement_errors(held, before)[0], 0.123, 1e-15);
}

/// A bar under tension p: the mean over its end, and the largest displacement, at a corner of the end, which no
/// boundary point reaches quite.
TEST(DisplacementErrors, AreOfTheDisplacementsThatTargetsName) {
  const auto solved = test::run_text(test::pulled_bar_text());
  ASSERT_TRUE(solved->results().converged) << solved->results().diagnosis;
  solved->scene.accuracy.named = {{NamedTarget::Kind::pressure, "some pair", 0.1},
                                  {NamedTarget::Kind::displacement, "largest", 0.1},
                                  {NamedTarget::Kind::displacement, "bar.z+", 0.1}};
  solved->scene.accuracy_faces["bar.z+"] = solved->scene.loads[0].face;
  const std::vector<Vec3> named = named_displacements(solved->simulation->state);
  ASSERT_EQ(named.size(), 2u);
  const double e = 1e-3, nu = 0.3, corner = e * Vec3(-nu * 0.5, -nu * 0.4, 1).norm();
  EXPECT_LT(named[0][0], corner);
  EXPECT_GT(named[0][0], 0.98 * corner);
  EXPECT_EQ(named[0].tail<2>().norm(), 0);
  EXPECT_LT((named[1] - e * Vec3(-nu * 0.25, -nu * 0.2, 1)).norm(), 1e-9 * e);
}

/// Energies of a cube of n^3 cells under a stress that depends on the distance from its middle, which is that of a cell
/// on every grid of an odd number of cells. error: of the energy norm, relative, within two cells from the middle.
template <class Stress>
CellEnergies energies_around_the_middle(int n, double error, const Stress& stress) {
  CellEnergies cells;
  const double h = 1.0 / n;
  for (int c = 0; c < n * n * n; ++c) {
    cells.x.push_back(h * Vec3(c % n + 0.5, c / n % n + 0.5, c / (n * n) + 0.5));
    cells.h.push_back(h);
    cells.fraction.push_back(1);
    cells.volume.push_back(h * h * h);
    const double r = (cells.x.back() - Vec3::Constant(0.5)).norm();
    cells.energy.push_back(std::pow(stress(std::max(r, 0.5 * h)), 2) * cells.volume.back());
    cells.error.push_back(std::pow(r < 2 * h ? error : 0.01, 2) * cells.energy.back());
  }
  return cells;
}

/// On three grids, each of a third of the cells of the one before, a stress r^-a grows around r = 0 like h^-a, as the
/// cells there are alike. What is finite, or what the last solve has without an error, is not singular.
TEST(SingularPoints, AreWhereTheStressGrowsWithoutEnd) {
  const Scene scene = parse_scene(R"(
[[body]]
name = "cube"
shape = {box = {min = [0, 0, 0], max = [1, 1, 1]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.3
[[support]]
face = "cube.z-"
symmetry = true
)",
                                  "scene.toml");
  Simulation simulation(scene);
  simulation.state.bodies = make_body_models(scene);
  const auto points = [&](double error, const std::function<double(double)>& stress) {
    std::vector<std::vector<CellEnergies>> solves;
    for (const int n : {3, 9, 27}) solves.push_back({energies_around_the_middle(n, error, stress)});
    return singular_points(simulation.state, solves);
  };
  for (const double a : {0.3, 0.5}) {
    const auto stress = [a](double r) { return std::pow(r, -a); };
    const std::vector<SingularPoint> found = points(0.4, stress);
    ASSERT_EQ(found.size(), 1u) << a;
    EXPECT_EQ(found[0].body, "cube");
    EXPECT_LT((found[0].x - Vec3::Constant(0.5)).norm(), 1e-12);
    EXPECT_NEAR(found[0].exponent, a, 1e-9);
    EXPECT_NEAR(found[0].cell, 1.0 / 27, 1e-12);
    EXPECT_NE(describe(found[0]).find("body \"cube\": the stress at (0.5, 0.5, 0.5) m"), std::string::npos);
    EXPECT_TRUE(points(0.1, stress).empty()) << "its error is small";
  }
  EXPECT_TRUE(points(0.4, [](double r) { return std::pow(std::max(r, 0.3), -0.5); }).empty()) << "finite";
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
