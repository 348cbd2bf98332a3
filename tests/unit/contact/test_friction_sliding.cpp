/// Friction where its pressure depends on itself (wedges, inclines steeper than 45 degrees, soft pads: with mu p lagged
/// behind the pressure none converges), and where nothing else holds a body.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/numbers/types.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_friction_sliding {
namespace {

/// Errors relative to the largest force: ten times the program's outer tolerance.
constexpr double settled = 1e-5;

const FrictionFigures& friction(const Results& r) { return *r.pairs[0].friction; }

/// Half of a wedge (8 degrees) that a force F drives in, F = N sin + mu N cos, then let go in two steps: it stays,
/// since tan(8 degrees) < mu, and without load asks for tan(8 degrees) of the pressure.
TEST(FrictionSlides, DrivenWedge) {
  constexpr double force = 1000, mu = 0.2, angle = 8 * pi / 180;
  for (const double offset : {0.3, 0.7}) {
    const auto solved = test::run_text(fmt::format(R"scene(
plane_strain = "x"
[parameters]
angle = "8 deg"
[[body]]
name = "wedge"
material = {{E = 210e9, nu = 0.3}}
cell_size = 0.00025
grid = {{offset = [0.1, {0}, 0.3]}}
[body.shape.extrude]
x = [0, 1, 0]
normal = [1, 0, 0]
height = 0.0002
profile = [
  [0, 0],
  [0.004, 0],
  {{to = ["4 mm+20 mm*tan(angle)", 0.02], name = "flank"}},
  {{to = [0, 0.02], name = "head"}},
  {{to = [0, 0], name = "middle"}},
]
[[body]]
name = "block"
material = {{E = 210e9, nu = 0.3}}
cell_size = 0.0002325
grid = {{offset = [0.1, {1}, 0.2]}}
[body.shape.extrude]
x = [0, 1, 0]
normal = [1, 0, 0]
height = 0.0002
profile = [
  ["4 mm-4 mm*tan(angle)", -0.004],
  [0.02, -0.004],
  {{to = [0.02, 0.016], name = "side"}},
  ["4 mm+16 mm*tan(angle)", 0.016],
  {{to = ["4 mm-4 mm*tan(angle)", -0.004], name = "flank"}},
]
[[support]]
face = "wedge.middle"
symmetry = true
[[support]]
face = "block.side"
displacement = {{y = 0, z = 0}}
[[load]]
face = "wedge.head"
force = [0, 0, {2}]
steps = [1, 0]
[[contact]]
faces = ["wedge.flank", "block.flank"]
friction = {3}
)scene",
                                                   offset, 0.7 * offset, -force, mu),
                                       {});
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    const double pressed = force / (std::sin(angle) + mu * std::cos(angle));
    EXPECT_NEAR(r.steps[0].pairs[0].zone.normal_force / pressed, 1, settled) << offset;
    EXPECT_EQ(r.steps[0].pairs[0].friction->stick_area, 0) << "it slides in all over";
    EXPECT_NEAR(*friction(r).use / (std::tan(angle) / mu), 1, settled) << offset;
  }
}

/// A block on an incline of 48 degrees, mu = 1.2: it holds, and asks for tan(48 degrees) of the pressure.
TEST(FrictionSlides, SteepIncline) {
  const auto solved = test::run_text(R"(
plane_strain = "x"
gravity = [0, 0, -9.81]
[[material]]
name = "m"
E = 200e9
nu = 0.3
density = 7800
[[body]]
name = "plane"
material = "m"
shape = {name = "p", box = {min = [0, 0, -0.008], max = [0.0007, 0.06, 0]}, rotate = {axis = [1, 0, 0], angle = 48}}
cell_size = 0.0013
grid = {offset = [0, 0.31, 0.62], rotation = {axis = [1, 0, 0], angle = 7}}
[[body]]
name = "block"
material = "m"
shape = {name = "b", box = {min = [0, 0.02, 0], max = [0.0007, 0.04, 0.006]}, rotate = {axis = [1, 0, 0], angle = 48}}
cell_size = 0.001
grid = {offset = [0, 0.17, 0.45], rotation = {axis = [1, 0, 0], angle = -23}}
[[support]]
face = "plane.p.z-"
displacement = {y = 0, z = 0}
[[contact]]
faces = ["block.b.z-", "plane.p.z+"]
friction = 1.2
)",
                                     {});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  EXPECT_NEAR(*friction(r).use / (std::tan(48 * pi / 180) / 1.2), 1, settled);
}

/// A soft pad that is pressed by 2 % and pulled along by 2 mm of its 10: it tilts, and slides with all that it carries.
TEST(FrictionSlides, SoftPad) {
  const auto solved = test::run_text(R"(
plane_strain = "x"
[[body]]
name = "plate"
material = "steel"
shape = {box = {min = [0, -0.01, -0.008], max = [0.0007, 0.05, 0]}}
cell_size = 0.0013
grid = {offset = [0, 0.31, 0.62]}
[[body]]
name = "pad"
material = {E = 3e6, nu = 0.45}
shape = {box = {min = [0, 0, 0], max = [0.0007, 0.04, 0.01]}}
cell_size = 0.001
grid = {offset = [0, 0.17, 0.45]}
[[support]]
face = "plate.z-"
displacement = {y = 0, z = 0}
[[support]]
face = "pad.z+"
displacement = {z = -0.0002}
[[support]]
face = "pad.z+"
displacement = {y = 0.002}
steps = [0, 0.5, 1]
[[contact]]
faces = ["pad.z-", "plate.z+"]
friction = 0.6
)",
                                     {});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const auto& pair = r.pairs[0];
  EXPECT_NEAR(std::abs(friction(r).force[1]) / (0.6 * pair.zone.normal_force), 1, settled);
  EXPECT_EQ(friction(r).stick_area, 0);
}

/// A block between plates that spreads as it is pressed, mu = 0.05: nothing but friction on both sides of its middle
/// holds it, and nearly all of it slips. As much work as in two halves with symmetry, to what the grids of these
/// differ.
TEST(FrictionSlides, SymmetricBlock) {
  const auto pressed = [](bool half) {
    const std::string left = half ? "0" : "-0.02", left_of_block = half ? "0" : "-0.012";
    std::string text = fmt::format(R"(
plane_strain = "x"
[[body]]
name = "low"
material = "steel"
shape = {{box = {{min = [0, {0}, -0.018], max = [0.0007, 0.02, -0.006]}}}}
cell_size = 0.0013
grid = {{offset = [0, 0.31, 0.62]}}
[[body]]
name = "block"
material = "aluminium"
shape = {{box = {{min = [0, {1}, -0.006], max = [0.0007, 0.012, 0.006]}}}}
cell_size = 0.001
grid = {{offset = [0, 0.17, 0.45]}}
[[body]]
name = "up"
material = "steel"
shape = {{box = {{min = [0, {0}, 0.006], max = [0.0007, 0.02, 0.018]}}}}
cell_size = 0.0013
grid = {{offset = [0, 0.71, 0.2]}}
[[support]]
face = "low.z-"
displacement = {{y = 0, z = 0}}
[[support]]
face = "up.z+"
displacement = {{y = 0}}
[[load]]
face = "up.z+"
pressure = 60e6
[[contact]]
faces = ["block.z-", "low.z+"]
friction = 0.05
[[contact]]
faces = ["block.z+", "up.z-"]
friction = 0.05
[steps]
loads = [0.5, 1]
)",
                                   left, left_of_block);
    for (const char* body : {"low", "block", "up"})
      if (half) text += fmt::format("[[support]]\nface = \"{}.y-\"\nsymmetry = true\n", body);
    return test::run_text(text, {});
  };
  const auto whole = pressed(false), half = pressed(true);
  const Results &r = whole->results(), &h = half->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  ASSERT_TRUE(h.converged) << h.diagnosis;
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(r.pairs[k].friction->work / (2 * h.pairs[k].friction->work), 1, 0.01);
    EXPECT_LT(r.pairs[k].friction->stick_area, 0.1 * r.pairs[k].friction->slip_area);
  }
}

/// A pin in a bushing, 20 um smaller in radius, pressed down, let go and pressed again: it may roll and turn, and rests
/// in balance after every step.
TEST(FrictionSlides, PinInABushing) {
  constexpr double force = 800;
  const auto solved = test::run_text(R"(
plane_strain = "x"
[parameters]
t = 0.0007
r = 0.01
c = 2e-5
[[body]]
name = "bush"
material = {E = 110e9, nu = 0.34}
cell_size = 0.0012
grid = {offset = [0, 0.31, 0.62]}
[body.shape]
difference = [
  {name = "o", box = {min = [0, -0.02, -0.02], max = ["t", 0.02, 0.02]}},
  {name = "bore", cylinder = {base = [-1, 0, 0], top = [1, 0, 0], radius = "r"}},
]
[[body]]
name = "pin"
material = "steel"
cell_size = 0.001
grid = {offset = [0, 0.21, 0.12]}
[body.shape]
difference = [
  {name = "p", cylinder = {base = [0, 0, "-c"], top = ["t", 0, "-c"], radius = "r-c"}},
  {name = "hole", cylinder = {base = [-1, 0, "-c"], top = [1, 0, "-c"], radius = 0.003}},
]
[[support]]
face = "bush.o.z-"
displacement = {y = 0, z = 0}
[[load]]
face = "pin.hole.side"
force = [0, 0, -800]
steps = [0.5, 1, 0.1, 1]
[[contact]]
faces = ["pin.p.side", "bush.bore.side"]
friction = 0.2
)",
                                     {});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  for (const BodyBalance& b : r.balance) EXPECT_LT((b.loads + b.supports + b.contact).norm(), settled * force);
  EXPECT_LT(*friction(r).use, 1e-3) << "by symmetry friction carries nothing on the whole";
  EXPECT_GT(friction(r).slip_area, 0);
}

/// A ball in a groove, on cells as wide as its contact zones, pressed by a weight W and pushed along with 0.3 of what
/// friction carries: the solve and the balance of rigid bodies, each with bounds of its own, came to different states
/// in turn.
TEST(FrictionSlides, BallInAGroove) {
  constexpr double weight = 200;
  const auto solved = test::run_text(R"scene(
[parameters]
R = 0.008
W = 200
Q = "0.3*0.2*W*sqrt(2)"
[[body]]
name = "right"
material = {E = 2e9, nu = 0.3}
cell_size = 0.00144
grid = {offset = [0.1, 0.3333, 0.65]}
[body.shape]
box = {min = [0, -0.01, -0.006], max = [0.016, 0.01, 0]}
rotate = {axis = [0, 1, 0], angle = -45}
translate = [0, 0, "-R*sqrt(2)"]
[[body]]
name = "left"
material = {E = 2e9, nu = 0.3}
cell_size = 0.00144
grid = {offset = [0.04, 0.8, 0.05]}
[body.shape]
box = {min = [-0.016, -0.01, -0.006], max = [0, 0.01, 0]}
rotate = {axis = [0, 1, 0], angle = 45}
translate = [0, 0, "-R*sqrt(2)"]
[[body]]
name = "ball"
material = {E = 2e9, nu = 0.3}
cell_size = 0.0012
grid = {offset = [0.8, 0.08, 0.15]}
[body.shape]
intersection = [
  {name = "s", sphere = {center = [0, 0, 0], radius = "R"}},
  {name = "cut", box = {min = [-1, -1, -1], max = [1, 1, 0.003]}},
]
[[support]]
face = "right.z-"
displacement = {x = 0, y = 0, z = 0}
[[support]]
face = "left.z-"
displacement = {x = 0, y = 0, z = 0}
[[load]]
face = "ball.cut.z+"
force = [0, 0, "-W"]
[[load]]
face = "ball.cut.z+"
force = [0, "Q", 0]
at = [0, 0, "-R/sqrt(2)"]
steps = [0, 1]
[[contact]]
faces = ["ball.s.surface", "right.z+"]
friction = 0.2
[[contact]]
faces = ["ball.s.surface", "left.z+"]
friction = 0.2
)scene",
                                     {});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  for (const BodyBalance& b : r.balance) EXPECT_LT((b.loads + b.supports + b.contact).norm(), settled * weight);
  for (const PairFigures& pair : r.pairs) {
    EXPECT_GT(pair.friction->slip_area, 0) << "the groove gives way and rubs, also before the push";
    EXPECT_LT(*pair.friction->use, 1 + settled);
  }
}

/// A pad pressed on a plate by a force P, and dragged along by a displacement in the same step: mu P resists, to the
/// outer tolerance. Points that stick all over would tilt it far beyond what friction does.
TEST(FrictionSlides, PadDraggedAtOnce) {
  constexpr double force = 500;
  for (const double mu : {0.05, 0.3, 1.0}) {
    const auto solved = test::run_text(fmt::format(R"scene(
plane_strain = "x"
[[body]]
name = "plate"
material = {{E = 210e9, nu = 0.3}}
cell_size = 0.0012
grid = {{offset = [0, 0.403, 0.545]}}
shape = {{name = "b", box = {{min = [0, -0.01, -0.008], max = [0.0006, 0.04, 0]}}}}
[[body]]
name = "pad"
material = {{E = 70e9, nu = 0.33}}
cell_size = 0.001
grid = {{offset = [0, 0.248, 0.255]}}
shape = {{name = "b", box = {{min = [0, 0, 0], max = [0.0006, 0.024, 0.004]}}}}
[[support]]
face = "plate.z-"
displacement = {{y = 0, z = 0}}
[[support]]
face = "pad.z+"
displacement = {{y = 0.0002}}
[[load]]
face = "pad.z+"
force = [0, 0, {0}]
[[contact]]
faces = ["pad.z-", "plate.z+"]
friction = {1}
)scene",
                                                   -force, mu),
                                       {});
    const Results& r = solved->results();
    ASSERT_TRUE(r.converged) << r.diagnosis;
    EXPECT_NEAR(r.pairs[0].force_on_first[2] / force, 1, settled);
    EXPECT_NEAR(friction(r).force[1] / (-mu * force), 1, settled / mu);
  }
}

/// Half of a wedge (5 degrees) that a force F drives in against much friction (mu = 1): F = N sin + mu N cos. The first
/// solve, without friction, has N twelve times as large.
TEST(FrictionSlides, WedgeHeldByFriction) {
  constexpr double force = 150, mu = 1, angle = 5 * pi / 180;
  const auto solved = test::run_text(fmt::format(R"scene(
plane_strain = "x"
[parameters]
c = "tan(5 deg)"
[[body]]
name = "wedge"
material = {{E = 210e9, nu = 0.3}}
cell_size = 0.001
grid = {{offset = [0, 0.403, 0.545]}}
[body.shape.extrude]
x = [0, 1, 0]
normal = [1, 0, 0]
height = 0.0006
profile = [
  [0, -0.008],
  ["10 mm-8 mm*c", -0.008],
  {{to = ["10 mm+8 mm*c", 0.008], name = "flank"}},
  {{to = [0, 0.008], name = "head"}},
  {{to = [0, -0.008], name = "middle"}},
]
[[body]]
name = "block"
material = {{E = 210e9, nu = 0.3}}
cell_size = 0.0012
grid = {{offset = [0, 0.248, 0.255]}}
[body.shape.extrude]
x = [0, 1, 0]
normal = [1, 0, 0]
height = 0.0006
profile = [
  ["10 mm-12 mm*c", -0.012],
  [0.028, -0.012],
  {{to = [0.028, 0.012], name = "side"}},
  ["10 mm+12 mm*c", 0.012],
  {{to = ["10 mm-12 mm*c", -0.012], name = "flank"}},
]
[[support]]
face = "block.side"
displacement = {{y = 0, z = 0}}
[[support]]
face = "wedge.middle"
displacement = {{y = 0}}
[[load]]
face = "wedge.head"
force = [0, 0, {}]
[[contact]]
faces = ["wedge.flank", "block.flank"]
friction = 1.0
)scene",
                                                 -force),
                                     {});
  const Results& r = solved->results();
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const double normal = force / (std::sin(angle) + mu * std::cos(angle));
  EXPECT_NEAR(friction(r).force.norm() / (mu * normal), 1, settled);
}

/// Where a displacement presses, the estimated error of the force weighs what the stiffness leaves by a solution with
/// unit forces. What slips hardly changes either.
TEST(FrictionSlides, ErrorOfTheForceIsAsWithoutFriction) {
  const auto pressed = [](double coefficient) {
    return test::run_text(fmt::format(R"(
plane_strain = "x"
[[body]]
name = "plate"
material = {{E = 70e9, nu = 0.33}}
shape = {{box = {{min = [0, -0.01, -0.01], max = [0.00015, 0.01, 0]}}}}
cell_size = 0.0002
grid = {{offset = [0, 0.31, 0.62]}}
[[body]]
name = "roller"
material = "steel"
cell_size = 0.00018
grid = {{offset = [0, 0.21, 0.12]}}
[body.shape]
intersection = [
  {{name = "r", cylinder = {{base = [0, 0, 0.01], top = [0.00015, 0, 0.01], radius = 0.01}}}},
  {{name = "c", box = {{min = [-1, -1, -1], max = [1, 1, 0.004]}}}},
]
[[support]]
face = "plate.z-"
displacement = {{y = 0, z = 0}}
[[support]]
face = "roller.c.z+"
displacement = {{y = 0, z = -1e-4}}
[[contact]]
faces = ["plate.z+", "roller.r.side"]
friction = {}
)",
                                      coefficient),
                          {});
  };
  const auto without = pressed(0), with = pressed(0.1);
  const Results &r = without->results(), &f = with->results();
  ASSERT_TRUE(r.converged && f.converged);
  ASSERT_TRUE(r.pairs[0].force_error_estimate && f.pairs[0].force_error_estimate);
  ASSERT_GT(friction(f).slip_area, 0) << "nothing slips: the case proves nothing";
  EXPECT_NEAR(*f.pairs[0].force_error_estimate / *r.pairs[0].force_error_estimate, 1, 0.2);
}

}  // namespace
}  // namespace cgcontact::test_friction_sliding
