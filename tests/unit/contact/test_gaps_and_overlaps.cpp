/// Contact as it is found from the geometry: real overlaps and gaps of many cells, thin bodies, conforming faces,
/// bodies that contact alone holds.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "contact/preparation.hpp"
#include "contact/results/verdict/missed_contact.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_gaps_and_overlaps {
namespace {

Scene read(const std::string& name, const std::vector<std::string>& overrides = {}) {
  return read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/" + name, overrides);
}

/// Mean SPR-C pressure of both faces, Pa.
double mean_pressure(const Results& r) {
  double force = 0, area = 0;
  for (const ContactRow& row : r.contact_rows) force += row.weight * row.pressure_sprc, area += row.weight;
  return force / area;
}

/// A shrink fit by overlap of the geometry, delta on the radius of 0.7 m, has the pressure of the one by the key
/// `interference`; the radii differ by half of the overlap, so pressures differ by a small multiple of delta / R.
/// Overlap up to 3 cells of the finer grid.
TEST(Overlap, ShrinkFitOfRings) {
  for (const auto& [n, delta] : {std::pair("n=8", 1e-3), {"n=48", 0.05}}) {
    const std::string d = "delta=" + std::to_string(delta);
    const auto key = test::run_scene("scenes/rings.toml", {n, d});
    const auto real =
        test::run_scene("scenes/rings.toml",
                        {n, d, "body.inner.shape.difference.0.intersection.1.cylinder.radius=b+delta/2",
                         "body.outer.shape.difference.1.cylinder.radius=b-delta/2", "contact=[{automatic = true}]"});
    ASSERT_TRUE(real->results().converged) << real->results().diagnosis;
    EXPECT_EQ(real->results().active_points, real->results().pairs[0].points);
    const double ratio = mean_pressure(real->results()) / mean_pressure(key->results());
    EXPECT_NEAR(ratio, 1, 2 * delta / 0.7) << n;
    // The key's and the geometry's runs cut the cells differently: twice the error of the pressure on the coarser grid.
    EXPECT_LT(test::zone(real->results(), "whole").sprc, test::zone(key->results(), "whole").sprc + 2 * delta / 0.7);
  }
}

TEST(Overlap, ShrinkFitOfASphere) {
  const double delta = 0.02;
  const std::vector<std::string> common = {"n=8", "delta=" + std::to_string(delta)};
  const auto key = test::run_scene("scenes/sphere_in_shell.toml", common);
  auto overrides = common;
  overrides.insert(overrides.end(),
                   {"body.sphere.shape.intersection.1.sphere.radius=b+delta/2",
                    "body.shell.shape.difference.1.sphere.radius=b-delta/2", "contact=[{automatic = true}]"});
  const auto real = test::run_scene("scenes/sphere_in_shell.toml", overrides);
  ASSERT_TRUE(real->results().converged) << real->results().diagnosis;
  EXPECT_NEAR(mean_pressure(real->results()) / mean_pressure(key->results()), 1, 2 * delta / 0.7);
}

/// Overlaps that contact cannot take are refused: a tenth of the smaller body, or more than its wall.
TEST(Overlap, TooLargeIsRefused) {
  const auto message = [](const std::vector<std::string>& overrides) {
    try {
      prepare(read("tests/scenes/gap.toml", overrides));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message({"gap=-0.09"}), "accepted");
  EXPECT_NE(message({"gap=-0.15"}).find("overlaps body"), std::string::npos) << message({"gap=-0.15"});
  const std::string thin = "body.upper.shape.box={min = [0, 0, 0.55], max = [1, 0.8, 0.59]}";  // all of it inside
  EXPECT_NE(message({thin, "body.upper.cell_size=0.02"}).find("overlaps body"), std::string::npos);
}

/// Rings with clearance (given by the geometry, 2.4 cells) close under pressure from outside; Lame's solution with a
/// clearance between rings of a common radius, which differs by the order of clearance / radius.
TEST(Gap, OfRingsClosesUnderPressure) {
  const double a = 0.4, b = 0.7, c = 1.0, g = 0.05, E = 200e9, nu = 0.3, q = 20e9;
  Scene scene = read("scenes/rings.toml",
                     {"n=48", "delta=0.05", "body.inner.shape.difference.0.intersection.1.cylinder.radius=b-delta/2",
                      "body.outer.shape.difference.1.cylinder.radius=b+delta/2", "contact=[{automatic = true}]"});
  scene.loads.emplace_back();
  scene.loads[0].face.body = 1;
  scene.loads[0].face.face.surfaces = {"rim.side"};
  scene.loads[0].pressure = Expression(q);
  Simulation simulation(scene);
  simulation.run({});
  const Results& r = simulation.results;
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const double inner = ((1 - 2 * nu) * b * b * b + a * a * b) / (b * b - a * a);
  const double outer = ((1 - 2 * nu) * b * b * b + b * c * c) / (c * c - b * b);
  const double p = (2 * (1 - nu) * b * c * c / (c * c - b * b) * q - g * E / (1 + nu)) / (inner + outer);
  ASSERT_GT(p, 0.1 * q);
  EXPECT_EQ(r.active_points, r.pairs[0].points);
  // g E / (1 + nu) is 0.6 of what the load does: an error of g / b in either weighs 1 / (1 - 0.6).
  EXPECT_NEAR(mean_pressure(r) / p, 1, 2.5 * g / b);
}

/// A gap of three cells and more: named faces find each other at any distance.
TEST(Gap, OfManyCells) {
  const auto solved = test::run_scene("tests/scenes/gap.toml", {"gap=0.6", "solver.tolerance=1e-11"});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  for (const ContactRow& row : r.contact_rows) EXPECT_NEAR(row.pressure_sprc / 1e9, 1, 1e-8);
}

/// Plates of one cell, found automatically: every point meets the face next to it, none the far side of the neighbour
/// or the plate behind it.
TEST(ThinBodies, TheFarSideIsNeverMet) {
  const Scene scene =
      read("tests/scenes/three_blocks.toml", {"body.a.shape.box={min = [0, 0, 0], max = [1, 1, 0.1]}",
                                              "body.b.shape.box={min = [0, 0, 0.1], max = [1, 1, 0.14]}",
                                              "body.c.shape.box={min = [0, 0, 0.14], max = [1, 1, 0.2]}"});
  const Preparation p = prepare(scene);
  ASSERT_EQ(p.pairs.size(), 2u);  // a and c see nothing of each other
  for (const ContactPair& pair : p.pairs) {
    double area = 0;
    for (const ContactPoint& q : pair.points) {
      EXPECT_EQ(q.distance, 0);
      area += q.weight;
    }
    EXPECT_NEAR(area, 1, 1e-12);
  }
  for (const BodyModel& body : p.bodies)
    for (std::size_t i = 0; i < body.cut_cells.boundary.size(); ++i) {
      const double z = body.point(static_cast<int>(i))[2];
      if (std::abs(body.normal(static_cast<int>(i))[2]) < 0.5) continue;
      const int expected = std::abs(z - 0.1) < 1e-9 ? 0 : std::abs(z - 0.14) < 1e-9 ? 1 : -1;
      EXPECT_EQ(body.boundary.pair_of_point[i], expected) << body.spec->name << " z = " << z;
    }
}

/// A loose pin in a hole, held by contact alone: it carries its weight, faces in contact do not overlap, open ones have
/// a gap; the arc of contact is found on a grid half as fine within a cell of either.
TEST(PinInAHole, CarriesTheWeight) {
  double angle[2];
  for (const int fine : {0, 1}) {
    const int n = fine ? 40 : 20;
    const auto solved = test::run_scene("tests/scenes/pin.toml", {fine ? "n=40" : "n=20", "t=0.05"});
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    const double weight = 1e9 * 0.05 * pi * 0.25 / 2;
    EXPECT_NEAR(std::abs(r.pairs[0].force_on_first[2]) / weight, 1, 1e-6);
    double top = 0;
    for (const ContactRow& row : r.contact_rows) {
      if (!std::isfinite(row.gap)) continue;
      EXPECT_GT(row.gap, -0.02 / n) << row.x.transpose();  // the gap is zero in the mean of each group
      if (row.pressure_sprc > 0.02 * r.pairs[0].max_pressure) top = std::max(top, std::atan2(row.x[0], -row.x[2]));
    }
    angle[fine] = top;
  }
  EXPECT_GT(angle[1], 0.3);
  EXPECT_NEAR(angle[0], angle[1], (1 / 20.0 + 1 / 40.0) / 0.5);
}

/// Approaches beyond what the pair sees at first: the run sees that and looks farther, with the result of a run that
/// looks far enough from the start.
TEST(PinInAHole, SeesAsFarAsItHasTo) {
  const std::vector<std::string> heavy = {"clearance=0.2", "weight=4e11", "recovery.spr_c=false"};
  const auto solved = test::run_scene("tests/scenes/pin.toml", heavy);
  auto overrides = heavy;
  overrides.push_back("contact=[{automatic = true, search_distance = 0.6}]");
  const auto far = test::run_scene("tests/scenes/pin.toml", overrides);
  ASSERT_TRUE(solved->results().converged && far->results().converged);
  const double first = std::max(2 / 20.0, 0.05);  // reach before the solve: two cells
  double farthest = 0;
  for (const ContactPoint& q : far->simulation->state.pairs[0].points)
    if (q.active) farthest = std::max(farthest, q.distance);
  ASSERT_GT(farthest, first) << "the case proves nothing";
  EXPECT_EQ(solved->results().active_points, far->results().active_points);
  EXPECT_NEAR(solved->results().pairs[0].force_on_first.norm() / far->results().pairs[0].force_on_first.norm(), 1,
              1e-5);
}

/// Small cells at the contact of bodies that nothing else holds: the zone grows over many of them, and what resists a
/// rolling ball is small against the springs of large cells. The bounds are half of what was needed when every
/// iteration balanced the rigid bodies anew (27, and more than 30); as many as on one size of cells.
TEST(HeldByContact, OnRefinedGrids) {
  const std::string sphere = "{center = [0, 0, -0.51], radius = 0.2}";
  const auto pin =
      test::run_scene("tests/scenes/pin.toml", {"body.block.refine=[{sphere = " + sphere + ", size = \"1/(4*n)\"}]",
                                                "body.pin.refine=[{sphere = " + sphere + ", size = \"1/(5*n)\"}]"});
  ASSERT_TRUE(pin->results().converged) << pin->results().diagnosis;
  EXPECT_LE(pin->results().outer_iterations, 14);
  EXPECT_NEAR(std::abs(pin->results().pairs[0].force_on_first[2]) / (1e9 * 0.06 * pi * 0.25 / 2), 1, 1e-6);

  const auto ball = test::run_scene("tests/scenes/free_ball.toml", {});
  ASSERT_TRUE(ball->results().converged) << ball->results().diagnosis;
  EXPECT_LE(ball->results().outer_iterations, 14);
  const Vec3 force = ball->results().pairs[0].force_on_first;
  EXPECT_NEAR(std::abs(force[2]) / 628.32, 1, 1e-6);
  EXPECT_LT(force.head<2>().norm(), 1e-5 * std::abs(force[2])) << "the springs take no force";
  EXPECT_LT(test::zone(ball->results(), "whole").sprc, 0.05) << "six cells over the radius of the zone";
}

/// Two pairs hold a ball that nothing else holds; it may spin, which is held without any force, whichever body is
/// coarser (that one's normals count).
TEST(HeldByContact, BallInAGroove) {
  for (const char* ratio : {"ratio=1.2", "ratio=0.8"}) {
    const auto solved = test::run_scene("tests/scenes/ball_in_groove.toml", {ratio});
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    const double weight = 1e8 * 2 * pi / 3 * 0.125;
    // Flanks of 45 degrees. The ball's normals count where it is coarser: its contact is a few cells wide, and a centre
    // that is a tenth of a cell off turns the force by 0.1 h / R = 3 %.
    for (const PairFigures& pair : r.pairs) {
      EXPECT_NEAR(pair.force_on_first.norm() / (weight / std::sqrt(2.0)), 1, 0.05);
      EXPECT_NEAR(pair.force_on_first[2] / (-0.5 * weight), 1, 0.05);
    }
    EXPECT_NEAR((r.pairs[0].force_on_first + r.pairs[1].force_on_first)[2] / -weight, 1, 1e-6);
    EXPECT_NEAR((r.pairs[0].force_on_first + r.pairs[1].force_on_first)[0] / weight, 0, 1e-6);
    double held = 0;
    for (std::size_t s = 0; s < solved->simulation->state.supports.size(); ++s) {
      const SupportPoint& p = solved->simulation->state.supports[s];
      if (p.support < 0) held += std::abs(p.weight * solved->simulation->state.outer.support_stress[s]);
    }
    EXPECT_LT(held, 1e-6 * weight);
  }
}

/// The gap is the same all round: closing the smallest one would glue the pin in, and all of it would open again. The
/// force follows from equilibrium; the pin touches over less than half of the hole, below it.
TEST(HeldByContact, PinInAHoleWithClearance) {
  for (const char* load : {"line_load=3.6e6", "line_load=3.6e5"}) {
    const auto solved = test::run_scene("tests/scenes/pin_in_hole.toml", {load});
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    const double force = 0.5 * std::stod(std::string(load).substr(10)) * 2e-3;
    EXPECT_NEAR(r.pairs[0].force_on_first[1] / -force, 1, 1e-6);
    for (const ContactPoint& point : solved->simulation->state.pairs[0].points)
      EXPECT_TRUE(!point.active || point.x[1] < 0) << point.x.transpose();
  }
}

/// Statics; the spin about y, which only the ball's own surface leaves free, is held so softly that it takes nothing.
/// Without that multigrid diverged. Contact a few cells wide turns the forces of wall and floor a little.
TEST(HeldByContact, BallInACorner) {
  for (const char* h : {"h=1e-3", "h=1.2e-3"}) {
    const auto solved = test::run_scene("tests/scenes/ball_in_corner.toml", {h});
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    EXPECT_TRUE(std::any_of(r.warnings.begin(), r.warnings.end(), [](const std::string& warning) {
      return warning.find("body \"ball\" is free to rotate about y") != std::string::npos;
    }));
    const double weight = 1.4e8 * 2 * pi / 3 * 1e-6;
    EXPECT_NEAR(r.pairs[0].force_on_first[2] / -weight, 1, 1e-3);
    EXPECT_NEAR(r.pairs[0].force_on_first[0] / (-0.6 * weight), 1, 1e-3);
  }
}

std::string refusal(const std::string& scene, const std::vector<std::string>& overrides) {
  try {
    prepare(read(scene, overrides));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

/// What loads drive is refused, whichever body is coarser; what only one side's points resist slides with a warning and
/// is the same in both cases. Flat faces that slide on each other: test_nasty_input.py, "slides".
TEST(FreeMotion, DrivenMotionsAreRefusedOthersHeld) {
  for (const char* ratio : {"ratio=1.2", "ratio=0.8"}) {
    const std::string spin = refusal("tests/scenes/ball_in_groove.toml", {"spin=1e6", ratio});
    EXPECT_NE(spin.find("body \"ball\" is free to rotate about y, and the loads drive it"), std::string::npos) << spin;
    const std::vector<std::string> whole = {"body.ball.shape.intersection.1.box.min=[-1, -1, -1]",
                                            "support.2.face=block.base.y+", ratio};
    const Scene scene = read("tests/scenes/ball_in_groove.toml", whole);
    const Preparation prepared = prepare(scene);
    EXPECT_TRUE(std::any_of(prepared.warnings.begin(), prepared.warnings.end(), [](const std::string& warning) {
      return warning.find("body \"ball\" is free to move along y") != std::string::npos;
    }));
    std::vector<std::string> pushed = whole;
    pushed.push_back("body.ball.body_force=[0, 1e7, -1e8]");
    const std::string slide = refusal("tests/scenes/ball_in_groove.toml", pushed);
    EXPECT_NE(slide.find("body \"ball\" is free to move along y"), std::string::npos) << slide;
    EXPECT_NE(slide.find("the loads drive it"), std::string::npos) << slide;
  }
}

/// A body that loses the contact that holds it, while another pair stays closed, is named.
TEST(FreeMotion, LostContactIsNamed) {
  const auto solved = test::run_scene("tests/scenes/ball_in_groove.toml", {"sideways=1.5"});  // rolls out of the groove
  const Results& r = solved->results();
  EXPECT_FALSE(r.converged);
  EXPECT_NE(r.diagnosis.find("body \"ball\" is free to"), std::string::npos) << r.diagnosis;
}

/// Two rollers of one rigid tool on a block, 20 um deep; cells resolve the zone of the first. The second is `lift` (m)
/// higher, on cells of 4 mm whose groups stay open.
std::string two_rollers(double lift) {
  const std::string grid = R"(
cell_size = 0.004
refine = [{sphere = {center = [-0.02, 0, 0], radius = 0.0015}, size = 6e-5}]
)";
  return fmt::format(R"(
plane_strain = "z"
[[body]]
name = "block"
shape = {{box = {{min = [-0.05, -0.05, 0], max = [0.05, 0, 0.001]}}}}
material = {{E = 210e9, nu = 0.3}}{0}
[[body]]
name = "tool"
rigid = true
shape = {{union = [
  {{name = "a", cylinder = {{base = [-0.02, 0.01, 0], top = [-0.02, 0.01, 0.001], radius = 0.01}}}},
  {{name = "b", cylinder = {{base = [0.02, {1}, 0], top = [0.02, {1}, 0.001], radius = 0.01}}}},
  {{name = "bar", box = {{min = [-0.03, 0.01, 0], max = [0.03, 0.02, 0.001]}}}}]}}
faces = [{{name = "both", surfaces = ["a.side", "b.side"]}}]{0}
[[support]]
face = "block.y-"
displacement = {{x = 0, y = 0}}
[[support]]
face = "tool.bar.y+"
displacement = {{x = 0, y = "-20 um"}}
[[contact]]
faces = ["block.y+", "tool.both"]
)",
                     grid, 0.01 + lift);
}

/// A zone that coarse cells lose beside one that presses: the verdict says where, how deep, and that the rest is
/// resolved. By the law of its overlap it would carry six times what the first one does, which has the same shape: the
/// law takes all of the depth for the approach near the zone, most of which is the block's between the zone and its
/// support. Nothing is missed where the second roller is apart or would carry less than a hundredth.
TEST(HiddenOverlaps, AreFoundBesideAZoneThatPresses) {
  const auto lost = test::run_text(two_rollers(0), {});
  const Results& results = lost->results();
  ASSERT_TRUE(results.converged);
  EXPECT_EQ(results.verdict.state, Verdict::State::contact_missed) << results.verdict.text;
  ASSERT_TRUE(results.verdict.pairs[0].of_closed);
  EXPECT_EQ(*results.verdict.pairs[0].of_closed, Verdict::State::resolved);
  EXPECT_LT(*results.pairs[0].min_gap, -15e-6);
  EXPECT_GT(*results.pairs[0].min_gap, -20.5e-6);
  EXPECT_NEAR(results.pairs[0].min_gap_at[0], 0.02, 1e-4);
  double force = 0;
  for (const HiddenOverlap& overlap : hidden_overlaps(lost->simulation->state, 0)) force += overlap.force;
  const double ratio = force * lost->simulation->state.bodies[0].slices / results.pairs[0].force_on_first.norm();
  EXPECT_GT(ratio, 4);
  EXPECT_LT(ratio, 8);
  for (const double lift : {30e-6, 19.95e-6}) {
    const auto found = test::run_text(two_rollers(lift), {});
    EXPECT_EQ(found->results().verdict.state, Verdict::State::resolved) << found->results().verdict.text;
    EXPECT_FALSE(found->results().pairs[0].min_gap);
  }
}

}  // namespace
}  // namespace cgcontact::test_gaps_and_overlaps
