/// Bodies that contact alone holds: forces against statics, whatever the order of the bodies; what is free is named.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <sstream>

#include "tests/support/run_scene.hpp"

namespace cgcontact::test_held_by_contact {
namespace {

/// The scene with its bodies in the opposite order; they come first in the files.
std::string reversed(const std::string& name) {
  std::ifstream file(std::string(CGCONTACT_SOURCE_DIR) + "/tests/scenes/" + name + ".toml");
  std::stringstream text;
  text << file.rdbuf();
  const std::string all = text.str(), mark = "[[body]]";
  const std::size_t end = all.find("[[support]]");
  std::vector<std::size_t> start;
  for (std::size_t at = all.find(mark); at < end; at = all.find(mark, at + 1)) start.push_back(at);
  start.push_back(end);
  std::string result = all.substr(0, start.front());
  for (std::size_t k = start.size() - 1; k-- > 0;) result += all.substr(start[k], start[k + 1] - start[k]);
  const std::string path = testing::TempDir() + "/" + name + "_reversed.toml";
  std::ofstream(path) << result + all.substr(end);
  return path;
}

std::unique_ptr<test::SolvedScene> solve(const std::string& path, const std::vector<std::string>& overrides = {}) {
  auto solved = std::make_unique<test::SolvedScene>();
  solved->scene = read_scene(path, overrides);
  solved->simulation = std::make_unique<Simulation>(solved->scene);
  solved->simulation->run({});
  return solved;
}

std::vector<std::unique_ptr<test::SolvedScene>> in_both_orders(const std::string& name,
                                                               std::vector<std::string> overrides = {}) {
  overrides.push_back("recovery.spr_c=false");
  std::vector<std::unique_ptr<test::SolvedScene>> solved;
  solved.push_back(test::run_scene("tests/scenes/" + name + ".toml", overrides));
  solved.push_back(solve(reversed(name), overrides));
  return solved;
}

int body_named(const test::SolvedScene& solved, const std::string& name) {
  for (std::size_t b = 0; b < solved.scene.bodies.size(); ++b)
    if (solved.scene.bodies[b].name == name) return static_cast<int>(b);
  throw std::logic_error("no body " + name);
}

/// Returns the force of all contact between two bodies, on the first one, N.
Vec3 force_on(const test::SolvedScene& solved, const std::string& first, const std::string& second) {
  const int a = body_named(solved, first), b = body_named(solved, second);
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < solved.simulation->state.pairs.size(); ++k) {
    const ContactPair& pair = solved.simulation->state.pairs[k];
    const Vec3& force = solved.results().pairs[k].force_on_first;
    if (pair.spec->first.body == a && pair.spec->second.body == b) sum += force;
    if (pair.spec->first.body == b && pair.spec->second.body == a) sum -= force;
  }
  return sum;
}

/// Sum of the magnitudes at points that are no support of the scene, N.
double force_of_holds(const test::SolvedScene& solved) {
  double held = 0;
  for (std::size_t s = 0; s < solved.simulation->state.supports.size(); ++s) {
    const SupportPoint& p = solved.simulation->state.supports[s];
    if (p.support < 0) held += std::abs(p.weight * solved.simulation->state.outer.support_stress[s]);
  }
  return held;
}

bool warns(const Results& results, const std::string& text) {
  return std::any_of(results.warnings.begin(), results.warnings.end(),
                     [&](const std::string& warning) { return warning.find(text) != std::string::npos; });
}

/// Each ball is in equilibrium to the tolerance of the outer iteration, and nothing but contact carries it. Where
/// exactly a ball touches is known to a fraction of a cell (the zones are smaller than one here), and with it the
/// direction of the force: the forces between the balls are those of statics to 0.5 h / R.
TEST(HeldByContact, ThreeBallsInABox) {
  const double r = 10e-3, weight = 1e9 * 4 * pi / 3 * r * r * r;
  const double slope = std::sqrt(4 * r * r - 14e-3 * 14e-3) / 14e-3;  // of the line of centres
  for (const auto& solved : in_both_orders("balls_in_box")) {
    const Results& results = solved->results();
    ASSERT_TRUE(results.converged) << results.diagnosis;
    const Vec3 load(0.1 * weight, 0.2 * weight, -weight);
    const Vec3 left = force_on(*solved, "top", "left"), right = force_on(*solved, "top", "right");
    EXPECT_LT((load + left + right + force_on(*solved, "top", "box")).norm(), 1e-6 * weight);
    EXPECT_LT((load - left + force_on(*solved, "left", "box") + force_on(*solved, "left", "right")).norm(),
              1e-6 * weight);
    EXPECT_LT((load - right + force_on(*solved, "right", "box") + force_on(*solved, "right", "left")).norm(),
              1e-6 * weight);
    EXPECT_LT(force_of_holds(*solved), 1e-6 * weight);
    // Coarse grids see hardly anything of what holds the balls: 42 to 143 iterations each, were the bodies' rigid
    // motions not solved for beside them after the first; 12 on average now.
    const std::vector<int>& linear = results.linear_iterations;
    EXPECT_LE(std::accumulate(linear.begin(), linear.end(), 0), 20 * static_cast<int>(linear.size()));
    // On top: the weight is shared alike, the lean towards +x by its difference.
    EXPECT_NEAR(left[2] / weight, 0.5 + 0.05 * slope, 0.125);
    EXPECT_NEAR(right[2] / weight, 0.5 - 0.05 * slope, 0.125);
  }
}

/// Six balls between a shaft and a ring, which roll and spin as they like: their springs let go, each at its own pace.
/// The forces are in balance with the load, alike on both sides of it, and nearly as rigid rings and Hertz's law share
/// it (Stribeck), cos(60 degrees)^1.5.
TEST(HeldByContact, BallsBetweenRings) {
  const auto solved = test::run_scene("tests/scenes/balls_between_rings.toml", {"recovery.spr_c=false"});
  ASSERT_TRUE(solved->results().converged) << solved->results().diagnosis;
  EXPECT_LE(solved->results().outer_iterations, 10);
  const double load = 400;
  const auto on_shaft = [&](int ball) { return force_on(*solved, "shaft", "ball_" + std::to_string(ball)); };
  Vec3 sum = Vec3::Zero();
  for (int ball = 1; ball <= 6; ++ball) {
    sum += on_shaft(ball);
    EXPECT_LT((on_shaft(ball) + force_on(*solved, "ring", "ball_" + std::to_string(ball))).norm(), 1e-6 * load);
  }
  EXPECT_LT((sum - Vec3(load, 0, 0)).norm(), 1e-6 * load);
  EXPECT_NEAR(on_shaft(2).norm() / on_shaft(4).norm(), 1, 0.01);
  EXPECT_NEAR(on_shaft(2).norm() / on_shaft(3).norm(), std::pow(0.5, 1.5), 0.03);
  for (const int ball : {1, 5, 6}) EXPECT_EQ(on_shaft(ball).norm(), 0);
  EXPECT_LT(force_of_holds(*solved), 1e-6 * load);
}

/// Opposite walls would cancel, whatever they carry: only the floor may (its weight widens the block by 5e-7 m).
TEST(HeldByContact, BlockInACavity) {
  for (const char* clearance : {"clearance=1e-5", "clearance=1e-4"})
    for (const auto& solved : in_both_orders("block_in_cavity", {clearance})) {
      const Results& results = solved->results();
      ASSERT_TRUE(results.converged) << results.diagnosis;
      const double weight = 1e7 * 0.02 * 0.018 * 0.016;
      EXPECT_LT((force_on(*solved, "block", "shell") - Vec3(0, 0, weight)).norm(), 1e-6 * weight);
      double carried = 0;
      for (const ContactPoint& q : solved->simulation->state.pairs[0].points)
        EXPECT_TRUE(!q.active || q.x[2] < 1e-6) << q.x;
      for (const double force : solved->simulation->state.outer.group_force) carried += std::abs(force);
      const Scales& scales = solved->simulation->state.scales;
      EXPECT_NEAR(carried * scales.stress * scales.length * scales.length / weight, 1, 1e-6);
    }
}

/// The ball may slide and spin, whichever body is coarser, and no load drives it: springs that take nothing in the end,
/// and a warning. A load that drives it is refused.
TEST(HeldByContact, BallBetweenPlates) {
  for (const char* ratio : {"ratio=0.8", "ratio=1.25"}) {
    for (const auto& solved : in_both_orders("ball_between_plates", {ratio})) {
      const Results& results = solved->results();
      ASSERT_TRUE(results.converged) << results.diagnosis;
      EXPECT_TRUE(warns(results, "body \"ball\" is free to move in the plane normal to z"));
      const double force = 1e5 * 9e-4;
      EXPECT_NEAR(force_on(*solved, "ball", "lower")[2] / force, 1, 1e-6);
      EXPECT_NEAR(force_on(*solved, "ball", "upper")[2] / -force, 1, 1e-6);
      EXPECT_LT(force_of_holds(*solved), 1e-6 * force);
    }
    try {
      test::run_scene("tests/scenes/ball_between_plates.toml", {ratio, "sideways=1e5"});
      FAIL() << "accepted";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("body \"ball\" is free to move"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("the loads drive it"), std::string::npos) << error.what();
    }
  }
}

/// No load: the motion of a plate squeezes the ball, whose zones are a quarter to half a cell. Their law gives the
/// force to a quarter (measured: 0.87 to 1.22 of Hertz's), the same on both sides.
TEST(HeldByContact, BallSqueezedByALedPlate) {
  const double force = 4.0 / 3 * 1e9 / (2 * (1 - 0.09)) * std::sqrt(10e-3) * std::pow(0.5e-4, 1.5);
  for (const std::vector<std::string>& cells : {std::vector<std::string>{"n=4"}, {"n=6"}, {"n=4", "ratio=1.3"}})
    for (const auto& solved : in_both_orders("ball_led", cells)) {
      const Results& results = solved->results();
      ASSERT_TRUE(results.converged) << results.diagnosis;
      EXPECT_NEAR(force_on(*solved, "ball", "lower")[2] / force, 1, 0.25) << cells[0];
      EXPECT_NEAR(force_on(*solved, "ball", "upper")[2] / -force, 1, 0.25) << cells[0];
      EXPECT_LT((force_on(*solved, "ball", "upper") + force_on(*solved, "ball", "lower")).norm(), 1e-5 * force);
      EXPECT_EQ(results.verdict.state, Verdict::State::not_resolved);
      EXPECT_LT(force_of_holds(*solved), 1e-5 * force);
    }
}

/// Flush faces: the active set of the plain iteration cycles between two states here, even while the lagged stress is
/// kept; the energy along each step decides instead. Vertical forces by statics.
TEST(HeldByContact, StackInACorner) {
  for (const auto& solved : in_both_orders("stack_in_corner")) {
    const Results& results = solved->results();
    ASSERT_TRUE(results.converged) << results.diagnosis;
    const double low = 1e7 * 0.017 * 0.0129 * 0.0115, middle = 1e7 * 0.017 * 0.0129 * 0.0088,
                 top = 1e7 * 0.0152 * 0.0129 * 0.0112, weight = low + middle + top;
    EXPECT_LT((force_on(*solved, "top", "middle") - Vec3(0, 0, top)).norm(), 1e-6 * weight);
    EXPECT_LT((force_on(*solved, "middle", "low") - Vec3(0, 0, top + middle)).norm(), 1e-6 * weight);
    EXPECT_LT((force_on(*solved, "low", "corner") - Vec3(0.1 * low, 0.07 * low, weight)).norm(), 1e-6 * weight);
  }
}

/// Nothing acts: no force, no motion, and the next step is solved as if it were the first.
TEST(HeldByContact, StepWithoutLoad) {
  const auto solved = test::run_scene("tests/scenes/stack_in_corner.toml", {"steps.factors=[0, 1]"});
  const Results& results = solved->results();
  ASSERT_TRUE(results.converged) << results.diagnosis;
  ASSERT_EQ(results.steps.size(), 2u);
  EXPECT_TRUE(results.steps[0].converged);
  for (const PairFigures& pair : results.steps[0].pairs) {
    EXPECT_EQ(pair.force_on_first.norm(), 0);
    EXPECT_EQ(pair.max_pressure, 0);
  }
  EXPECT_TRUE(warns(results, "step 1 of 2: nothing acts"));
  const double low = 1e7 * 0.017 * 0.0129 * 0.0115;
  EXPECT_NEAR(force_on(*solved, "low", "corner")[0] / (0.1 * low), 1, 1e-5);
}

}  // namespace
}  // namespace cgcontact::test_held_by_contact
