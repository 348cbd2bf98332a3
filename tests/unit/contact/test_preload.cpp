/// Pairs that are tightened to a force: the force is there, the interference that gives it is the one known.
#include <gtest/gtest.h>

#include "contact/preparation.hpp"
#include "contact/solve/forces/preload.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_preload {
namespace {

/// Two bars in a row between fixed ends, of 0.6 and 0.7 m: an interference d presses them with d/(0.6/E1 + 0.7/E2).
std::string bars(const std::string& pair, const std::string& more = "") {
  return R"(
[[body]]
name = "lower"
shape = {box = {min = [0, 0, 0], max = [0.5, 0.4, 0.6]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.13
[[body]]
name = "upper"
shape = {box = {min = [0, 0, 0.6], max = [0.5, 0.4, 1.3]}}
material = {E = 70e9, nu = 0.2}
cell_size = 0.11
grid = {offset = [0.3, 0.6, 0.2]}
[[support]]
face = "lower.z-"
symmetry = true
[[support]]
face = "upper.z+"
symmetry = true
[[support]]
face = "lower.x-"
symmetry = true
[[support]]
face = "lower.y-"
symmetry = true
[[support]]
face = "upper.x-"
symmetry = true
[[support]]
face = "upper.y-"
symmetry = true
[[contact]]
faces = ["lower.z+", "upper.z-"]
)" + pair +
         more;
}

/// The bars are linear: exact to the tolerance of the preload, 1e-6. What the scene gives as a clearance is closed too.
TEST(Preload, FindsTheInterference) {
  const double F = 5e3, interference = F / 0.2 * (0.6 / 200e9 + 0.7 / 70e9);
  for (const char* given : {"", "interference = 1e-7\n", "interference = -1e-7\n"}) {
    const auto solved = test::run_text(bars("preload = \"5 kN\"\n" + std::string(given)));
    const Results& r = solved->simulation->results;
    ASSERT_TRUE(r.converged) << r.diagnosis;
    EXPECT_NEAR(r.pairs[0].force_on_second[2] / F, 1, 2e-6) << given;
    EXPECT_NEAR(r.pairs[0].interference / interference, 1, 2e-6) << given;
    EXPECT_EQ(r.pairs[0].preload, F);
  }
}

/// Solves that a simulation needs: bars that just touch are linear; what was found on other grids needs no second one.
TEST(Preload, StartsFromWhatOtherGridsHad) {
  const Scene scene = parse_scene(bars("preload = 5e3\n"), "scene.toml", test::tight);
  const auto solves = [&](Simulation& simulation) {
    int count = 0;
    ProgressCallbacks progress;
    progress.step = [&](const OuterStep& step) { count += step.iteration == 1; };
    simulation.set_up(progress);
    simulation.solve(progress);
    return count;
  };
  Simulation first(scene), second(scene);
  EXPECT_EQ(solves(first), 2);
  second.start_preloads_from(first);
  EXPECT_EQ(solves(second), 1);
}

/// Two pairs in a row whose forces both follow both interferences, F = K d: Broyden's method ends after twice as many
/// steps as there are pairs, after the first one in proportion. The forces are given here, nothing is solved.
TEST(Preload, OfTwoPairsThatDependOnEachOther) {
  std::string text = bars("preload = 5e3\n", R"(
[[body]]
name = "last"
shape = {box = {min = [0, 0, 1.3], max = [0.5, 0.4, 1.8]}}
material = {E = 70e9, nu = 0.2}
cell_size = 0.15
[[contact]]
faces = ["upper.z+", "last.z-"]
preload = 3e3
)");
  const std::string held = "[[support]]\nface = \"upper.z+\"\nsymmetry = true\n";
  text.erase(text.find(held), held.size());
  const Scene scene = parse_scene(text, "scene.toml");
  const Preparation p = discretise(scene);
  ASSERT_EQ(p.pairs.size(), 2u);
  Preload preload(scene);
  EXPECT_TRUE(preload.any());
  preload.begin(p.bodies, p.pairs);
  Eigen::Matrix2d K;  // N/m
  K << 2e9, 0.5e9, 0.5e9, 1e9;
  const auto forces = [&] {
    const Eigen::Vector2d f = K * Eigen::Vector2d(preload.tightening(p.pairs[0]), preload.tightening(p.pairs[1]));
    return std::vector<double>{f[0], f[1]};
  };
  int steps = 0;
  while (preload.tighten(p.pairs, forces())) ASSERT_LE(++steps, 5);
  EXPECT_GT(steps, 1);
  EXPECT_NEAR(forces()[0] / 5e3, 1, 1e-6);
  EXPECT_NEAR(forces()[1] / 3e3, 1, 1e-6);
  const Eigen::Vector2d exact = K.inverse() * Eigen::Vector2d(5e3, 3e3);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(preload.tightening(p.pairs[k]) / exact[k], 1, 1e-5);
}

/// A quarter of a ball between plates: its zone, smaller than the cells, grows with the force (F ~ d^1.5).
TEST(Preload, TightensAZoneThatGrows) {
  const std::string plates = R"(
[[body]]
name = "ball"
material = {E = 210e9, nu = 0.3}
cell_size = 2e-3
grid = {offset = [0.3, 0.6, 0.2]}
[body.shape]
intersection = [
  {name = "quarter", box = {min = [0, 0, -1], max = [1, 1, 1]}},
  {name = "ball", sphere = {center = [0, 0, 0.01], radius = 0.01}},
]
[[body]]
name = "plate"
shape = {box = {min = [0, 0, -0.01], max = [0.01, 0.01, 0]}}
material = {E = 210e9, nu = 0.3}
cell_size = 2.4e-3
[[body]]
name = "lid"
shape = {box = {min = [0, 0, 0.02], max = [0.01, 0.01, 0.03]}}
material = {E = 210e9, nu = 0.3}
cell_size = 2.4e-3
[[support]]
face = "plate.z-"
displacement = {x = 0, y = 0, z = 0}
[[support]]
face = "lid.z+"
displacement = {x = 0, y = 0, z = 0}
[[support]]
face = "ball.quarter.x-"
symmetry = true
[[support]]
face = "ball.quarter.y-"
symmetry = true
[[contact]]
faces = ["ball.ball", "plate.z+"]
preload = "25 N"
[[contact]]
faces = ["ball.ball", "lid.z-"]
)";
  const auto solved = test::run_text(plates, {});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  // To the outer tolerance, 1e-6.
  for (const PairFigures& pair : r.pairs)
    EXPECT_NEAR(pair.force_on_second[2] / 25, &pair == &r.pairs[0] ? -1 : 1, 1e-5);
}

/// Tightened first, then heated: the interference stays, and the expansion of the upper bar comes to it.
TEST(Preload, IsKeptInLaterSteps) {
  std::string text = bars("preload = 5e3\n", "[steps]\nloads = [0, 1]\n");
  const std::string material = "material = {E = 70e9, nu = 0.2}\n";
  text.replace(text.find(material), material.size(),
               "material = {E = 70e9, nu = 0.2, expansion = 24e-6}\ntemperature = 0.01\n");
  const auto solved = test::run_text(text);
  const Results& r = solved->simulation->results;
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const double heated = 24e-6 * 0.01 * 0.7 * 0.2 / (0.7 / 70e9 + 0.6 / 200e9);
  EXPECT_NEAR(r.steps[0].pairs[0].force_on_second[2] / 5e3, 1, 2e-6);
  EXPECT_NEAR(r.steps[1].pairs[0].force_on_second[2] / (5e3 + heated), 1, 2e-6);
}

/// Where equilibrium alone gives the force no interference does.
TEST(Preload, ThatNothingGivesIsAnError) {
  std::string text = bars("preload = 5e3\n", "[[load]]\nface = \"upper.z+\"\nforce = [0, 0, -1e3]\n");
  const std::string held = "[[support]]\nface = \"upper.z+\"\nsymmetry = true\n";
  text.erase(text.find(held), held.size());
  try {
    const auto solved = test::run_text(text);
    FAIL() << "it was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("its preload of 5000 N is not reached"), std::string::npos)
        << error.what();
  }
}

/// The preload and equilibrium: head and nut carry the same, and under the load P the bolt's force is that of the
/// plates and P together. Forces to the outer tolerance (1e-6 of sigma*). The load at the rims of the plates comes off
/// what presses them together; the bolt's force is 0.9942, 0.9943, 0.9944 of the preload then (n = 4, 6, 8).
TEST(Preload, OfABoltCarriesTheLoad) {
  const auto solved = test::run_scene("scenes/bolted_joint.toml", {"n=4"});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const double F = 5e3, P = 2e3;
  ASSERT_EQ(r.steps.size(), 2u);
  const auto force = [&](int step, int pair) { return r.steps[step].pairs[pair].force_on_first.norm(); };
  for (const int pair : {0, 1, 2}) EXPECT_NEAR(force(0, pair) / F, 1, 1e-5) << pair;
  EXPECT_NEAR(force(1, 0) / force(1, 2), 1, 1e-5);
  EXPECT_NEAR((force(1, 1) + P) / force(1, 0), 1, 1e-5);
  EXPECT_NEAR(force(1, 0) / F, 0.9943, 1e-3);
}

}  // namespace
}  // namespace cgcontact::test_preload
