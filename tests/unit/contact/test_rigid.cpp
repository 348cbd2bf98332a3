/// Rigid bodies: exact under uniform pressure, in balance, Hertz with the compliance of one body; against a body that
/// is merely stiff; the mistakes that scenes with them can have.
#include <gtest/gtest.h>

#include "contact/adaptive_run.hpp"
#include "contact/results/figures/rigid_figures.hpp"
#include "tests/support/input_errors.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_rigid {
namespace {

constexpr double exact = 1e-10;
constexpr double E = 200e9, nu = 0.3;

/// A rigid block on an elastic cube of 10 mm. `more`: keys of the rigid block; further sections.
std::string blocks(const std::string& more, const std::string& sections) {
  return R"(
[[body]]
name = "lower"
shape = {name = "block", box = {min = [0, 0, 0], max = [0.01, 0.01, 0.01]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.0021
grid = {offset = [0.414, 0.732, 0.236]}

[[body]]
name = "upper"
rigid = true
shape = {name = "block", box = {min = [0, 0, 0.01], max = [0.01, 0.01, 0.015]}}
)" + more +
         R"(
[[contact]]
faces = ["lower.block.z+", "upper.block.z-"]
)" + sections;
}

std::string support(const std::string& face, const std::string& held) {
  return "[[support]]\nface = \"" + face + "\"\n" + held + "\n";
}

std::string symmetry(const std::vector<std::string>& faces) {
  std::string text;
  for (const std::string& face : faces) text += support(face, "symmetry = true");
  return text;
}

const std::string foot = support("lower.block.z-", "displacement = {x = 0, y = 0, z = 0}");

const RigidFigures& upper(const test::SolvedScene& solved) { return *solved.results().bodies[1].rigid; }

/// Forces and moments of loads, supports and contact on the rigid body add up to nothing.
void expect_balance(const test::SolvedScene& solved, double force, double moment) {
  const BodyBalance& balance = solved.results().balance[1];
  const RigidFigures& rigid = upper(solved);
  EXPECT_LT((balance.loads + balance.supports + balance.contact).norm(), exact * force);
  EXPECT_LT((rigid.loads + rigid.supports + rigid.contact).norm(), exact * moment);
}

/// 1 kN on faces that match: uniform pressure, and the block sinks by p H / E; whatever its own cells are.
TEST(Rigid, PressesUniformlyWithMatchingFaces) {
  for (const char* cells : {"", "cell_size = 0.0017\ngrid = {offset = [0.3, 0.6, 0.9]}\n", "cell_size = 0.004\n"}) {
    const auto solved = test::run_text(blocks(
        cells, symmetry({"lower.block.z-", "lower.block.x-", "lower.block.y-", "upper.block.x-", "upper.block.y-"}) +
                   "[[load]]\nface = \"upper.block.z+\"\nforce = [0, 0, -1000]\n"));
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    const double p = 1e7;
    EXPECT_EQ(r.unknowns, solved->simulation->state.system.meshes[0].num_free_dofs() + 6);
    double worst = 0;
    for (const ContactRow& row : r.contact_rows)
      for (const double pressure : {row.pressure_raw, row.pressure_spr, row.pressure_sprc, row.pressure_transmitted})
        worst = std::max(worst, std::abs(pressure - p));
    EXPECT_LT(worst, exact * p) << cells;
    EXPECT_NEAR(upper(*solved).displacement[2], -p * 0.01 / E, exact * p * 0.01 / E);
    EXPECT_EQ(upper(*solved).rotation, Vec3(0, 0, 0));
    EXPECT_LT(r.estimated_error_relative, exact);
    expect_balance(*solved, 1000, 5);
  }
}

/// A force askew and beside the centre, on a block that the bond alone holds: six unknowns, six reactions.
TEST(Rigid, IsInBalanceUnderAnyLoad) {
  const auto solved =
      test::run_text(blocks("", foot + "[[load]]\nface = \"upper.block.z+\"\nforce = [300, 100, -500]\nmoment = [0, 1, "
                                       "2]\nat = [0.007, 0.0055, 0.02]\n"),
                     {"contact.0.bonded=true", "solver.tolerance=1e-13", "solver.linear_tolerance=1e-15"});
  ASSERT_TRUE(solved->results().converged);
  expect_balance(*solved, 600, 4);
  const Vec3 moment = Vec3(0, 1, 2) + Vec3(0.002, 0.0005, 0.0075).cross(Vec3(300, 100, -500));
  EXPECT_LT((upper(*solved).loads - moment).norm(), 1e-9 * moment.norm());
  EXPECT_GT(upper(*solved).rotation.norm(), 1e-6);
}

/// Sideways on springs, tilted by a load beside the centre.
TEST(Rigid, IsInBalanceOnSprings) {
  const auto solved = test::run_text(
      blocks("", foot + support("upper.block.z+", "spring = [1e8, 1e8, 1e8]") +
                     "[[load]]\nface = \"upper.block.z+\"\nforce = [10, 0, -1000]\nat = [0.005, 0.0055, 0.02]\n"));
  ASSERT_TRUE(solved->results().converged);
  expect_balance(*solved, 1000, 1);
  // 10 N on 1e8 N/m, less what the tilt about y moves the face.
  EXPECT_LT(upper(*solved).rotation[0], -1e-7);
}

/// Gravity acts on its density.
TEST(Rigid, HasAWeight) {
  const auto solved =
      test::run_text("gravity = [0, 0, -9.81]\n" +
                         blocks("material = {density = 7850}\n", foot + symmetry({"upper.block.x-", "upper.block.y-"})),
                     {"body.lower.material.density=1", "solver.tolerance=1e-13", "solver.linear_tolerance=1e-15"});
  ASSERT_TRUE(solved->results().converged);
  const double weight = 9.81 * 7850 * 0.01 * 0.01 * 0.005;
  EXPECT_NEAR(solved->results().pairs[0].force_on_second[2], weight, 1e-9 * weight);
}

/// Prescribed displacements and rotations are met to rounding, and the reactions balance the contact. A small face
/// holds as well as a large one.
TEST(Rigid, MovesAsItsSupportsSay) {
  struct Case {
    const char *more, *face, *held;
    Vec3 displacement, rotation;
  };
  const double angle = 1e-3 * pi / 180;
  const std::string patch =
      "faces = [{name = \"patch\", surfaces = [\"block.z+\"], box = {min = [0, 0, 0], max = [0.001, 0.001, 1]}}]\n";
  const std::vector<Case> cases{
      {"", "upper.block.z+", "displacement = {x = 0, y = 0, z = -1e-6}", Vec3(0, 0, -1e-6), Vec3::Zero()},
      {patch.c_str(), "upper.patch", "displacement = {x = 0, y = 0, z = -1e-6}", Vec3(0, 0, -1e-6), Vec3::Zero()},
      {"", "upper.block.z+", "rotation = {axis = [1, 0, 0], angle = -1e-3, centre = [0.005, 0, 0.01]}",
       Vec3(0, angle * 0.0025, -angle * 0.005), Vec3(-angle, 0, 0)}};
  for (const Case& c : cases) {
    // Reactions of the firm supports are rounding below 1e-10.
    const auto solved = test::run_text(blocks(c.more, foot + support(c.face, c.held)),
                                       {"solver.tolerance=1e-9", "solver.linear_tolerance=1e-15"});
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << c.held << ": " << r.diagnosis;
    EXPECT_LT((upper(*solved).displacement - c.displacement).norm(), 1e-9 * c.displacement.norm()) << c.held;
    EXPECT_LT((upper(*solved).rotation - c.rotation).norm(), 1e-9 * c.displacement.norm() / 0.01) << c.held;
    const BodyBalance& balance = r.balance[1];
    EXPECT_GT(balance.contact.norm(), 100);
    EXPECT_LT((balance.supports + balance.contact).norm(), 1e-8 * balance.contact.norm()) << c.held;
  }
}

/// Hertz with the plate's compliance alone; and what a ball 1e5 times stiffer than the plate transmits (2e-5 of the
/// compliance, so that the pressure differs by that at most; solved to 1e-6).
TEST(Rigid, BallMeetsHertzAndAVeryStiffOne) {
  const auto solved = test::run_scene("scenes/rigid_ball.toml", {"n=5"});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  EXPECT_LT(test::zone(r, "whole").sprc, 0.03);                            // 0.020
  EXPECT_LT(test::zone(r, "whole").sprc, test::zone(r, "whole").spr / 4);  // 6.5
  EXPECT_NEAR(upper(*solved).displacement[2], -6.36e-6, 0.1e-6);  // 6.35e-6 with n = 20; Hertz 6.41e-6 in a half-space
  Scene scene = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/scenes/rigid_ball.toml", {"n=5"});
  scene.bodies[1].material = Material{1e5 * 210e9, 0.0};
  const auto stiff = test::run(std::move(scene));
  ASSERT_EQ(stiff->results().contact_rows.size(), r.contact_rows.size());
  double difference = 0, norm = 0;
  for (std::size_t i = 0; i < r.contact_rows.size(); ++i) {
    const ContactRow &a = r.contact_rows[i], &b = stiff->results().contact_rows[i];
    if (!std::isfinite(a.pressure_transmitted) || !std::isfinite(b.pressure_transmitted)) continue;
    difference += a.weight * std::pow(a.pressure_transmitted - b.pressure_transmitted, 2);
    norm += a.weight * std::pow(b.pressure_transmitted, 2);
  }
  EXPECT_LT(std::sqrt(difference / norm), 1e-3);
}

/// A rigid roller in plane strain, sizes from the accuracy asked for: Hertz's line contact.
TEST(Rigid, RollerMeetsHertzWithoutCellSizes) {
  const Scene scene = parse_scene(R"scene(
plane_strain = "x"

[parameters]
R = 0.01
t = 0.001
q = 2e5

[accuracy]
pressure = "2 %"

[[body]]
name = "block"
shape = {name = "block", box = {min = [0, 0, -0.005], max = ["t", 0.005, 0]}}
material = {E = 200e9, nu = 0.3}

[[body]]
name = "roller"
rigid = true
shape = {intersection = [
  {name = "rim", cylinder = {base = [0, 0, "R"], top = ["t", 0, "R"], radius = "R"}},
  {name = "cut", box = {min = [-1, 0, -1], max = [1, 1, "0.2*R"]}},
]}

[[load]]
face = "roller.cut.z+"
force = [0, 0, "-q*t"]

[[contact]]
faces = ["block.block.z+", "roller.rim.side"]

[reference]
pressure = "2*(2*q)/(pi*b)*sqrt(max(0, 1-y^2/b^2))"
parameters = {b = "sqrt(4*(2*q)*R*(1-0.3^2)/(pi*200e9))"}
)scene" + symmetry({"block.block.z-", "block.block.y-", "roller.cut.y-"}),
                                  "scene.toml", {});
  AdaptiveRun run(scene);
  run.run({});
  const Results& r = run.simulation().results;
  ASSERT_TRUE(r.converged) << r.diagnosis;
  EXPECT_TRUE(r.accuracy.reached) << r.accuracy.text;
  EXPECT_LT(test::zone(r, "whole").sprc, 0.02);
  EXPECT_TRUE(r.singular_points.empty());
}

/// One message each; those that the scene's text shows are among tests/bad_scenes.
TEST(Rigid, MistakesAreNamed) {
  const std::string third = R"(
[[body]]
name = "third"
rigid = true
shape = {box = {min = [0, 0, 0.015], max = [0.01, 0.01, 0.02]}}
cell_size = 0.0021
)" + support("third.box.z+", "displacement = {x = 0, y = 0, z = 0}") +
                            "[[contact]]\nautomatic = true\n";
  expect_contains(message_of([&] { test::run_text(blocks("", foot + third)); }), {"both bodies are rigid and touch"});
  const std::string bent = support("upper.block.z+", "displacement = {x = 0, y = 0, z = \"-1e-4*x*x\"}");
  expect_contains(message_of([&] { test::run_text(blocks("", foot + bent)); }),
                  {"upper.block.z+", "would deform the rigid body \"upper\""});
}

/// Under gravity a rigid body that supports hold wholly needs no density; one that is left a motion does.
TEST(Rigid, NeedsADensityOnlyToMove) {
  const auto text = [](const std::string& held) {
    std::string scene = blocks("", foot + held);
    scene.replace(scene.find("material = {E = 200e9"), 21, "material = {density = 7800, E = 200e9");
    return "gravity = [0, 0, -9.81]\n" + scene;
  };
  const auto solved = test::run_text(text(support("upper.block.z+", "displacement = {x = 0, y = 0, z = -1e-6}")), {});
  EXPECT_TRUE(solved->results().converged) << solved->results().diagnosis;
  for (const char* free :
       {"displacement = {x = 0, y = 0}", "displacement = {z = -1e-6}", "stiffness = [1e9, 1e9, 1e9]"})
    expect_contains(message_of([&] { test::run_text(text(support("upper.block.z+", free))); }),
                    {"\"upper\": it has no density", "leave it free to move", "density = 7850"});
}

/// A quarter of an elastic ball on a rigid plate that is whole, cut at the planes, or cut and held there: the same
/// zone, round, and Hertz's figures for the whole force. On a plate that leans to one side there is no image behind the
/// plane across which it leans.
TEST(Rigid, PartnerOfAQuarterNeedsNoCut) {
  const auto text = [](const std::string& plate, const std::string& more) {
    return R"(
[[body]]
name = "ball"
material = {E = 1e9, nu = 0.3}
cell_size = 1.2e-3
grid = {offset = [0.3, 0.2, 0.4]}
refine = [{sphere = {center = [0, 0, 0], radius = 1.2e-3}, size = 0.2e-3, grading = 0.4}]
shape = {intersection = [{name = "q", box = {min = [0, 0, 0], max = [8e-3, 8e-3, 8e-3]}},
                         {name = "ball", sphere = {center = [0, 0, 8e-3], radius = 8e-3}}]}
[[body]]
name = "plate"
rigid = true
shape = )" +
           plate + symmetry({"ball.q.x-", "ball.q.y-"}) + support("plate.z-", "displacement = {x = 0, y = 0, z = 0}") +
           more +
           "[[load]]\nface = \"ball.q.z+\"\nforce = [0, 0, -47.125]\n"
           "[[contact]]\nfaces = [\"ball.ball.surface\", \"plate.z+\"]\n";
  };
  const std::string whole = "{box = {min = [-8e-3, -9e-3, -2e-3], max = [8e-3, 7e-3, 0]}}\n",
                    cut = "{box = {min = [0, 0, -2e-3], max = [8e-3, 8e-3, 0]}}\n";
  for (const auto& [plate, more] :
       {std::pair<std::string, std::string>{whole, ""}, {cut, ""}, {cut, symmetry({"plate.x-", "plate.y-"})}}) {
    const auto solved = test::run_text(text(plate, more), {});
    ASSERT_TRUE(solved->results().converged) << solved->results().diagnosis;
    const ZoneFigures& zone = solved->results().pairs[0].zone;
    ASSERT_TRUE(zone.extent && zone.hertz);
    EXPECT_EQ(zone.extent->shape, ZoneExtent::Shape::round);
    const double a = std::cbrt(3 * 188.5 * 8e-3 / (4 * 1e9 / 0.91));
    // The normal force is a third of a per cent more than the load: the ball's normals lean by up to a/R = 0.13.
    EXPECT_NEAR(*zone.hertz->a / a, 1, 3e-3);
    EXPECT_NEAR(zone.hertz->p0 / (1.5 * 188.5 / (pi * a * a)), 1, 3e-3);
    for (const double half_axis : zone.extent->half_axes) EXPECT_NEAR(half_axis / a, 1, 0.08) << "six cells";
  }
  // It goes up along x by 3 degrees, so that its image behind x = 0 would go down: two halves, not four quarters.
  const std::string leaning =
      "{box = {min = [-8e-3, -9e-3, -2e-3], max = [8e-3, 7e-3, 0]}, rotate = {axis = [0, 1, 0], angle = -3}}\n";
  const auto solved = test::run_text(text(leaning, ""), {});
  ASSERT_TRUE(solved->results().converged) << solved->results().diagnosis;
  const ZoneFigures& zone = solved->results().pairs[0].zone;
  ASSERT_TRUE(zone.hertz);
  EXPECT_NEAR(*zone.hertz->a / std::cbrt(3 * 2 * zone.normal_force * 8e-3 / (4 * 1e9 / 0.91)), 1, 1e-6);
}

/// A rigid body of two boxes on an elastic block, on its grids and not solved: what acts on it, and its motion, are
/// given, in place of a solution. `first`: keys of the scene; `cells`: of both bodies.
std::string angle_on_block(const std::string& first, const std::string& cells, const std::string& faces) {
  return first + R"(
[[body]]
name = "lower"
shape = {box = {min = [0, 0, 0], max = [0.01, 0.005, 0.01]}}
material = {E = 200e9, nu = 0.3}
)" + cells +
         R"(
[[body]]
name = "angle"
rigid = true
shape = {union = [{name = "a", box = {min = [0, 0, 0.01], max = [0.01, 0.005, 0.015]}},
                  {name = "b", box = {min = [0, 0, 0.015], max = [0.004, 0.005, 0.02]}}]}
)" + cells +
         support("lower.z-", "displacement = {x = 0, z = 0}") + support("angle.a.x+", "displacement = {x = 0, z = 0}") +
         "[[load]]\nface = \"angle.b.z+\"\nforce = [300, 0, -500]\n" + "[[contact]]\nfaces = " + faces + "\n";
}

/// Moments about the centroid and the displacement there, by hand: in space, in plane strain (about the axis only) and
/// on a slice of it, which stands for the whole thickness, as the given contact forces do times its number of slices.
/// All integrals are of polynomials over planes.
TEST(RigidFigures, AreMomentsAndMotionOfTheCentroid) {
  const Vec3 a(0.005, 0.0025, 0.0125), b(0.002, 0.0025, 0.0175), c = (5 * a + 2 * b) / 7;
  const std::string plane = "plane_strain = \"y\"\n",
                    one_layer = "cell_size = 0.006\ngrid = {offset = [0.4, 0.1, 0.3]}\n",
                    refined =
                        one_layer + "refine = [{sphere = {center = [0, 0, 0.01], radius = 0.001}, size = 0.002}]\n";
  const std::string lower_first = "[\"lower.z+\", \"angle.a.z-\"]", angle_first = "[\"angle.a.z-\", \"lower.z+\"]";
  for (const std::string& text :
       {angle_on_block("", "cell_size = 0.0023\ngrid = {offset = [0.4, 0.7, 0.2]}\n", lower_first) +
            support("lower.y-", "symmetry = true") + support("angle.a.y-", "symmetry = true"),
        angle_on_block(plane, one_layer, angle_first), angle_on_block(plane, refined, lower_first)}) {
    const bool in_plane = text.substr(0, 5) == "plane", angle_is_first = text.find(angle_first) != std::string::npos;
    const Scene scene = parse_scene(text, "scene.toml");
    Simulation simulation(scene);
    simulation.set_up_grids();
    SolvedState& state = simulation.state;
    BodyMotion motion;
    motion.translation = Vec3(1e-6, 0, -3e-6);
    motion.rotation = Vec3(0, 2e-4, 1e-18);  // about z it is rounding
    motion.centre = Vec3(0.001, 0.002, 0.003);
    state.outer.body_motions = {BodyMotion(), motion};
    // 100 N along x and z on the side of 25 mm^2; planes of symmetry and the other body take something else.
    for (const SupportPoint& p : state.supports)
      state.outer.support_stress.push_back(p.support == 1 ? 4e6 : p.support == 3 ? 0 : 7e9);
    Results results;
    results.bodies.resize(2);
    results.pairs.resize(1);
    PairFigures& pair = results.pairs[0];
    const double slices = state.bodies[1].slices;
    const Vec3 force(10, -20, 30), moment(1, 2, 3);
    (angle_is_first ? pair.force_on_first : pair.force_on_second) = force / slices;
    (angle_is_first ? pair.moment_on_first : pair.moment_on_second) = moment / slices;
    (angle_is_first ? pair.force_on_second : pair.force_on_first) = Vec3(500, 600, 700);
    (angle_is_first ? pair.moment_on_second : pair.moment_on_first) = Vec3(50, 60, 70);
    set_rigid_figures(state, results.pairs, results.bodies);
    EXPECT_FALSE(results.bodies[0].rigid);
    ASSERT_TRUE(results.bodies[1].rigid);
    const RigidFigures& figures = *results.bodies[1].rigid;
    EXPECT_LT((figures.centre - c).norm(), exact * c.norm());
    const Vec3 moved = motion.translation + motion.rotation.cross(c - motion.centre);
    EXPECT_LT((figures.displacement - moved).norm(), exact * moved.norm());
    EXPECT_EQ(figures.rotation, Vec3(0, 2e-4, 0));
    const auto expect_moment = [&](const Vec3& found, const Vec3& expected) {
      const Vec3 known = in_plane ? Vec3(0, expected[1], 0) : expected;
      EXPECT_LT((found - known).norm(), exact * expected.norm()) << text;
    };
    expect_moment(figures.loads, (Vec3(0.002, 0.0025, 0.02) - c).cross(Vec3(300, 0, -500)));
    expect_moment(figures.contact, moment - c.cross(force));
    expect_moment(figures.supports, (Vec3(0.01, 0.0025, 0.0125) - c).cross(Vec3(100, 0, 100)));
  }
}

/// All around an axis the moments of a pressure cancel out.
TEST(RigidFigures, HaveNoMomentsAroundAnAxisOfRevolution) {
  const auto solved = test::run_text(R"(
axisymmetric = "z"
[[body]]
name = "rod"
shape = {cylinder = {base = [0, 0, 0], top = [0, 0, 0.03], radius = 0.02}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.0061
grid = {offset = [0.4, 0.1, 0.7]}
[[body]]
name = "disc"
rigid = true
shape = {cylinder = {base = [0, 0, 0.03], top = [0, 0, 0.04], radius = 0.02}}
[[load]]
face = "disc.top"
pressure = 1e6
[[contact]]
faces = ["rod.top", "disc.bottom"]
)" + support("rod.bottom", "displacement = {z = 0}") +
                                         support("disc.top", "stiffness = 1e9"),
                                     {});
  const RigidFigures& figures = *solved->results().bodies[1].rigid;
  for (const Vec3& moment : {figures.loads, figures.supports, figures.contact}) EXPECT_EQ(moment, Vec3(0, 0, 0));
  EXPECT_LT(figures.displacement[2], -1e-8);
}

}  // namespace
}  // namespace cgcontact::test_rigid
