/// Friction in whole scenes: exact states of blocks that stick and slide, a ball that is pressed and pushed, and what
/// must hold whatever the scene.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/input_errors.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_friction {
namespace {

/// Far below the bounds, so that these test the discretisation.
const std::vector<std::string> tight{"solver.tolerance=1e-12", "solver.linear_tolerance=1e-14"};

const FrictionFigures& friction(const Results& results) { return *results.pairs[0].friction; }

constexpr double p = 1e8, E = 2e11, G = E / 2, mu = 0.3, height = 0.013, area = 0.02 * 0.016;

/// Two blocks, one on the other, with the tractions of a uniform stress on all sides: pressure p and shear tau; nu = 0.
/// The bottom stands, `top` holds or loads the top besides. Grids turned by an angle, degrees, and shifted.
std::string sheared_blocks(double tau, const std::string& top, double angle, double shift) {
  std::string text;
  for (const bool upper : {false, true}) {
    const char* name = upper ? "upper" : "lower";
    text += fmt::format(
        "[[body]]\nname = \"{}\"\nmaterial = {{E = {}, nu = 0}}\ncell_size = {}\n"
        "shape = {{name = \"b\", box = {{min = [-0.01, -0.008, {}], max = [0.01, 0.008, {}]}}}}\n"
        "grid = {{offset = [{}, {}, {}], rotation = {{axis = [1, 2, 3], angle = {}}}}}\n",
        name, E, upper ? 0.0031 : 0.0043, upper ? 0.006 : 0.0, upper ? height : 0.006, 0.3 + shift, 0.7 - shift,
        upper ? shift : 0.9 - shift, upper ? angle : -angle);
    for (const int side : {-1, 1})
      text +=
          fmt::format("[[load]]\nface = \"{}.b.x{}\"\ntraction = [0, 0, {}]\n", name, side < 0 ? '-' : '+', side * tau);
  }
  return text + fmt::format(
                    "[[support]]\nface = \"lower.b.z-\"\ndisplacement = {{x = 0, y = 0, z = 0}}\n"
                    "[[load]]\nface = \"upper.b.z+\"\npressure = {}\n{}"
                    "[[contact]]\nfaces = [\"lower.b.z+\", \"upper.b.z-\"]\nfriction = {}\n",
                    p, top, mu);
}

/// Largest differences of pressure and shear of all contact rows from a uniform state, relative to p: recovered.
double worst_of_rows(const Results& results, double tau) {
  double worst = 0;
  for (const ContactRow& row : results.contact_rows) {
    const double side = row.normal[2];  // the shear on the lower body, whose normal is z, goes along x
    worst = std::max(worst, std::abs(row.pressure_sprc / p - 1));
    worst = std::max(worst, (row.shear_sprc - Vec3(side * tau, 0, 0)).norm() / p);
  }
  return worst;
}

struct Pose {
  double angle, shift;
};
/// Along the axes, turned, and with slivers of 1e-6 of a cell.
const Pose poses[] = {{0, 0}, {7, 0.11}, {0, 1e-6}};

/// Shear below mu p: all sticks, exact to the error of the solvers.
TEST(FrictionPatch, Sticks) {
  for (const Pose& pose : poses) {
    const double tau = 0.2 * p;
    const auto solved =
        test::run_text(sheared_blocks(tau, fmt::format("traction = [{}, 0, 0]\n", tau), pose.angle, pose.shift), tight);
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    EXPECT_LT(worst_of_rows(r, tau), 1e-10);
    EXPECT_EQ(friction(r).slip_area, 0);
    EXPECT_EQ(friction(r).max_slip, 0);
    EXPECT_NEAR(*friction(r).use, 0.2 / mu, 1e-10);
    EXPECT_EQ(verdict_on(friction(r)), "sticks everywhere");
  }
}

/// A step without loads, after which all points are open, leaves the next one as if it were the first: a plate between
/// jaws, both held by contact alone, is pressed and pulled.
TEST(Friction, StepWithoutLoadsChangesNothing) {
  constexpr double press = 1000, pull = 450;
  const auto solved = test::run_text(fmt::format(R"(
plane_strain = "x"
[[body]]
name = "low"
material = "steel"
shape = {{box = {{min = [0, 0, -0.01], max = [0.0014, 0.03, 0]}}}}
cell_size = 0.0026
grid = {{offset = [0, 0.31, 0.62]}}
[[body]]
name = "plate"
material = "steel"
shape = {{box = {{min = [0, -0.01, 0], max = [0.0014, 0.05, 0.005]}}}}
cell_size = 0.002
grid = {{offset = [0, 0.17, 0.45]}}
[[body]]
name = "top"
material = "steel"
shape = {{box = {{min = [0, 0, 0.005], max = [0.0014, 0.03, 0.015]}}}}
cell_size = 0.0026
grid = {{offset = [0, 0.73, 0.2]}}
[[support]]
face = "low.z-"
displacement = {{y = 0, z = 0}}
[[support]]
face = "top.z+"
displacement = {{y = 0}}
[[load]]
face = "top.z+"
force = [0, 0, {}]
[[load]]
face = "plate.y+"
force = [0, {}, 0]
steps = [0, 1]
[[contact]]
name = "lower"
faces = ["plate.z-", "low.z+"]
friction = 0.25
[[contact]]
name = "upper"
faces = ["plate.z+", "top.z-"]
friction = 0.25
[steps]
factors = [0, 1]
)",
                                                 -press, pull),
                                     {});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  double held = 0;
  for (const auto& pair : r.pairs) {
    EXPECT_NEAR(pair.zone.normal_force, press, 1e-5 * press);  // ten times the program's tolerance
    held += pair.friction->force[1];
  }
  EXPECT_NEAR(std::abs(held), pull, 1e-5 * pull);
}

/// Moved farther than mu p can hold: all slips, by what the blocks' own shear leaves, and dissipates half of mu p times
/// that, since pressure and slip grow together. The same load once more changes nothing.
TEST(FrictionPatch, Slips) {
  constexpr double tau = mu * p, moved = 1e-5, slip = moved - tau * height / G;
  for (const Pose& pose : poses) {
    const std::string top = fmt::format("[[support]]\nface = \"upper.b.z+\"\ndisplacement = {{x = {}}}\n", moved);
    std::vector<std::string> twice = tight;
    twice.emplace_back("steps.factors=[1, 1]");
    const auto solved = test::run_text(sheared_blocks(tau, top, pose.angle, pose.shift), twice);
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    EXPECT_LT(worst_of_rows(r, tau), 1e-10);
    EXPECT_NEAR(friction(r).max_slip / slip, 1, 1e-9);
    EXPECT_NEAR(friction(r).work / (tau * slip * area), 0.5, 1e-9);
    EXPECT_NEAR(friction(r).wear * mu, friction(r).work, 1e-9 * friction(r).work);
    EXPECT_NEAR(*friction(r).use, 1, 1e-10);
    EXPECT_LE(r.steps[1].outer_iterations, 4);  // held, released, and two that change nothing more
  }
}

/// A soft pad under a force that stays, pushed so far that all of it slides: it tilts, one end lifts off, and points
/// there rub until they open. Dissipates mu P times its slip, whatever the number of steps (0.07 less in one step where
/// the points that open are left out).
TEST(Friction, WorkDoesNotDependOnSteps) {
  constexpr double force = 200, coefficient = 0.35;
  const auto pushed = [&](const std::string& steps) {
    return test::run_text(fmt::format(R"(
plane_strain = "x"
[[body]]
name = "plate"
material = "steel"
shape = {{box = {{min = [0, 0, -0.008], max = [0.0007, 0.06, 0]}}}}
cell_size = 0.0013
grid = {{offset = [0, 0.31, 0.62]}}
[[body]]
name = "pad"
material = {{E = 5e9, nu = 0.3}}
shape = {{box = {{min = [0, 0.02, 0], max = [0.0007, 0.04, 0.012]}}}}
cell_size = 0.001
grid = {{offset = [0, 0.17, 0.45]}}
[[support]]
face = "plate.z-"
displacement = {{z = 0}}
[[support]]
face = "plate.z-"
displacement = {{y = 5e-4}}
steps = {}
[[support]]
face = "pad.z+"
displacement = {{y = 0}}
[[load]]
face = "pad.z+"
force = [0, 0, {}]
[[contact]]
faces = ["pad.z-", "plate.z+"]
friction = {}
)",
                                      steps, -force, coefficient),
                          {});
  };
  const auto one = pushed("[0, 1]"), four = pushed("[0, 0.3, 0.5, 0.8, 1]");
  const Results &r = one->results(), &s = four->results();
  ASSERT_TRUE(r.converged && s.converged);
  const FrictionFigures& before = *r.steps[0].pairs[0].friction;
  const double closed = before.stick_area + before.slip_area;
  ASSERT_LT(friction(r).slip_area, 0.9 * closed) << "nothing opens: the case proves nothing";
  ASSERT_EQ(friction(r).stick_area, 0);
  EXPECT_NEAR(friction(r).work / friction(s).work, 1, 1e-4);
  EXPECT_NEAR(friction(r).wear / friction(s).wear, 1, 1e-4);
  const double whole = coefficient * force * friction(r).max_slip;  // the pad's own strain makes other points slip less
  EXPECT_LT(friction(r).work, whole);
  EXPECT_GT(friction(r).work, 0.97 * whole);
}

/// mu so large that nothing slips: as if bonded, where nothing opens.
TEST(FrictionPatch, MuchFrictionIsABond) {
  std::string text = sheared_blocks(0.1 * p, fmt::format("traction = [{}, 0, 0]\n", 0.25 * p), 7, 0.11);
  text.resize(text.find("friction = "));
  const std::string bonded = text + "bonded = true\n";
  text += "friction = 2\n";
  const auto one = test::run_text(text, tight), two = test::run_text(bonded, tight);
  ASSERT_TRUE(one->results().converged);
  ASSERT_EQ(friction(one->results()).slip_area, 0) << "the case proves nothing";
  for (std::size_t b = 0; b < 2; ++b) {
    const BodyFields &first = one->results().bodies[b], &second = two->results().bodies[b];
    double worst = 0, largest = 0;
    for (int c = 0; c < static_cast<int>(first.cut_cells->cells.size()); ++c) {
      worst = std::max(worst, (first.displacement(c, Vec3::Zero()) - second.displacement(c, Vec3::Zero())).norm());
      largest = std::max(largest, second.displacement(c, Vec3::Zero()).norm());
    }
    EXPECT_LT(worst / largest, 1e-9);
  }
}

/// A ball of radius R on a plate of the same steel, pressed and then pushed along x (Cattaneo and Mindlin); half of it
/// is modelled. n cells over the contact radius a. Solved to the program's tolerance (1e-6): what is compared is a
/// hundredth and more.
std::string pushed_ball(int n, double a_over_R, const std::string& steps_of_push, double push) {
  const double a = 5e-4, R = a / a_over_R;
  std::string text;
  const auto body = [&](const char* name, double offset, const std::string& shape) {
    text += fmt::format(
        "[[body]]\nname = \"{}\"\nmaterial = {{E = 210e9, nu = 0.3}}\ncell_size = {}\n"
        "grid = {{offset = [{}, {}, 0.29]}}\n"
        "refine = [{{sphere = {{center = [0, 0, 0], radius = {}}}, size = {}, grading = 0.25}}]\nshape = {}\n",
        name, 64 * a / n, offset, offset / 2, 1.2 * a, a / n, shape);
  };
  body("ball", 0.37,
       fmt::format("{{intersection = [{{name = \"s\", sphere = {{center = [0, 0, {0}], radius = {0}}}}}, "
                   "{{name = \"cut\", box = {{min = [{1}, 0, {1}], max = [{0}, {0}, {2}]}}}}]}}",
                   R, -R, 0.4 * R));
  body("plate", 0.61, fmt::format("{{name = \"p\", box = {{min = [{1}, 0, {1}], max = [{0}, {0}, 0]}}}}", R, -R));
  for (const char* face : {"plate.p.y-", "ball.cut.y-"})
    text += fmt::format("[[support]]\nface = \"{}\"\nsymmetry = true\n", face);
  return text + fmt::format(
                    "[[support]]\nface = \"plate.p.z-\"\ndisplacement = {{x = 0, y = 0, z = 0}}\n"
                    "[[support]]\nface = \"ball.cut.z+\"\ndisplacement = {{z = {}}}\n"
                    "[[support]]\nface = \"ball.cut.z+\"\ndisplacement = {{x = {}}}\nsteps = {}\n"
                    "[[contact]]\nfaces = [\"ball.s.surface\", \"plate.p.z+\"]\nfriction = 0.3\n",
                    -1.0 * a * a / R, push, steps_of_push);
}

/// Mindlin's figures of the whole ball, from the forces of the half.
struct Mindlin {
  double P, Q, a, c;

  explicit Mindlin(const PairFigures& pair, double R) {
    P = 2 * std::abs(pair.force_on_first[2]);
    Q = 2 * std::abs(pair.force_on_first[0]);
    a = std::cbrt(3 * P * R * (1 - 0.09) * 2 / (4 * 210e9));
    c = a * std::cbrt(1 - Q / (0.3 * P));
  }
  double shear(double r) const {
    const double peak = 0.3 * 3 * P / (2 * pi * a * a), of_c = r < c ? std::sqrt(c * c - r * r) : 0;
    return r < a ? peak / a * (std::sqrt(a * a - r * r) - of_c) : 0;
  }
};

/// Shear within 0.3 in L2 with eight cells over the contact radius (0.15 with sixteen, docs/accuracy.md; it falls like
/// the square root of a cell at the front of slip), the stick radius within 1.5 cells, and no shear beyond mu p.
TEST(FrictionOfBall, PushedBallSticksInTheMiddle) {
  constexpr int n = 8;
  constexpr double a_over_R = 1.0 / 60;
  const auto solved = test::run_text(pushed_ball(n, a_over_R, "[0, 1]", 1.2e-6), {});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const Mindlin exact(r.pairs[0], 5e-4 / a_over_R);
  ASSERT_GT(exact.Q / (0.3 * exact.P), 0.3);
  ASSERT_LT(exact.Q / (0.3 * exact.P), 0.8);
  const double stick = std::sqrt(2 * friction(r).stick_area / pi);
  double error[2] = {0, 0}, norm[2] = {0, 0};
  for (const ContactRow& row : r.contact_rows) {
    if (!row.touching) continue;
    const double sign = row.body == 0 ? -1 : 1;  // friction holds the ball back
    const double tau = exact.shear(std::hypot(row.x[0], row.x[1]));
    error[row.body] += row.weight * (row.shear_sprc - Vec3(sign * tau, 0, 0)).squaredNorm();
    norm[row.body] += row.weight * tau * tau;
    EXPECT_LE(row.shear_sprc.norm(), (1 + 1e-12) * 0.3 * std::max(0.0, row.pressure_sprc));
  }
  std::printf("Q/(mu P) %.3f, c/a %.4f, exact %.4f; shear %.3f and %.3f off\n", exact.Q / (0.3 * exact.P),
              stick / exact.a, exact.c / exact.a, std::sqrt(error[0] / norm[0]), std::sqrt(error[1] / norm[1]));
  EXPECT_NEAR(stick, exact.c, 1.5 * 5e-4 / n);
  for (int b = 0; b < 2; ++b) EXPECT_LT(std::sqrt(error[b] / norm[b]), 0.3);
}

/// Pushed to and fro: the loop closes, every step dissipates, and a whole cycle what Mindlin and Deresiewicz (1953) say
/// for the force that it reaches, within the square of a cell over the contact radius.
TEST(FrictionOfBall, CyclesDissipate) {
  constexpr double a_over_R = 1.0 / 60, nu = 0.3, G_steel = 210e9 / (2 * (1 + nu));
  const auto solved = test::run_text(pushed_ball(8, a_over_R, "[0, 1, -1, 1, -1, 1]", 1.2e-6), {});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const auto work = [&](int step) { return r.steps[step].pairs[0].friction->work; };
  for (int k = 1; k < 6; ++k) EXPECT_GT(work(k), work(k - 1));
  const Vec3 first = r.steps[3].pairs[0].force_on_first, second = r.steps[5].pairs[0].force_on_first;
  EXPECT_LT((second - first).norm(), 1e-3 * std::abs(first[0]));
  const Mindlin exact(r.pairs[0], 5e-4 / a_over_R);
  const double q = exact.Q / (0.3 * exact.P), rest = 1 - q;
  const double cycle = 9 * (2 - nu) * std::pow(0.3 * exact.P, 2) / (5 * G_steel * exact.a) *
                       (1 - std::pow(rest, 5.0 / 3) - 5 * q / 6 * (1 + std::pow(rest, 2.0 / 3)));
  std::printf("cycle dissipates %.4g J, exact %.4g\n", 2 * (work(5) - work(3)), cycle);
  EXPECT_NEAR(2 * (work(5) - work(3)) / cycle, 1, 0.05);
}

/// The whole ball pressed, then twisted by a growing moment: slip has another direction at every point. Stick radii
/// over the contact radius, of Lubkin (1951) for M/(mu P a); within 1.5 cells (measured 0.03 to 0.2).
TEST(FrictionOfBall, TwistedBallSticksInTheMiddle) {
  constexpr int n = 8;
  constexpr double a_over_R = 1.0 / 60, P = 653.5, a = 5.032e-4;  // of the press alone
  constexpr struct {
    double moment, stick;
  } lubkin[] = {{0.17635, 0.9}, {0.40974, 0.7}, {0.52858, 0.5}, {0.57687, 0.3}};
  std::string text = pushed_ball(n, a_over_R, "[0, 0]", 0);
  const auto cut = [&](const std::string& from, const std::string& to) {
    const std::size_t first = text.find(from);
    text.erase(first, text.find(to, first) - first);
  };
  cut("[[support]]\nface = \"plate.p.y-\"", "[[support]]\nface = \"plate.p.z-\"");  // both planes of symmetry
  cut("[[support]]\nface = \"ball.cut.z+\"\ndisplacement = {x", "[[contact]]");
  const double R = 5e-4 / a_over_R;
  for (const std::string& half : {fmt::format("min = [{}, 0, {}]", -R, -R), fmt::format("min = [{}, 0, {}]", -R, -R)})
    text.replace(text.find(half), half.size(), fmt::format("min = [{}, {}, {}]", -R, -R, -R));
  text += fmt::format("[[load]]\nface = \"ball.cut.z+\"\nmoment = [0, 0, {}]\nsteps = [0, {}, {}, {}, {}]\n",
                      0.3 * P * a, lubkin[0].moment, lubkin[1].moment, lubkin[2].moment, lubkin[3].moment);
  const auto solved = test::run_text(text, {});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  for (int k = 0; k < 4; ++k) {
    const PairFigures& pair = r.steps[k + 1].pairs[0];
    const double stick = std::sqrt(pair.friction->stick_area / pi);
    std::printf("M/(mu P a) %.3f: sticks within %.3f a\n", lubkin[k].moment, stick / std::sqrt(pair.area / pi));
    EXPECT_NEAR(std::abs(pair.friction->torque->carried) / (lubkin[k].moment * 0.3 * P * a), 1, 0.01);
    EXPECT_NEAR(stick, lubkin[k].stick * a, 1.5 * 5e-4 / n);
    EXPECT_LT(pair.friction->force.norm(), 0.01 * 0.3 * P);
  }
}

/// What friction has done in a step without a solution is not known: no later step has one.
TEST(StepsOfFriction, EndWithAStepWithoutASolution) {
  const std::string top =
      fmt::format("[[load]]\nface = \"upper.b.z+\"\ntraction = [{}, 0, 0]\nsteps = [0.5, 1.5, 0.5]\n", mu * p);
  const auto solved = test::run_text(sheared_blocks(0, top, 0, 0));
  const Results& r = solved->results();
  EXPECT_FALSE(r.converged);
  expect_contains(r.diagnosis, {"step 2 of 3", "slides on"});
  ASSERT_EQ(r.steps.size(), 3u);
  EXPECT_TRUE(r.steps[0].converged);
  EXPECT_FALSE(r.steps[1].converged);
  EXPECT_FALSE(r.steps[2].converged);
}

/// Factors of single loads and supports: their own steps, as many as the scene has.
TEST(StepsOfFriction, MistakesAreTold) {
  const auto message = [](const std::string& steps, const std::vector<std::string>& more = {}) {
    return message_of([&] { test::run_text(pushed_ball(4, 1.0 / 60, steps, 1e-6), more); });
  };
  EXPECT_NE(message("[]").find("0 factors"), std::string::npos) << message("[]");
  EXPECT_NE(message("[0, 1]", {"steps.factors=[0.5, 0.7, 1]"}).find("has 2 factors, the scene 3 steps"),
            std::string::npos);
  EXPECT_NE(message("[0, \"x\"]").find("steps"), std::string::npos);
}

}  // namespace
}  // namespace cgcontact::test_friction
