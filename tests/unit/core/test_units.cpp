/// Units: their values to the last bit, dimensions of expressions, and what a scene takes and refuses.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/expressions/expression.hpp"
#include "core/scene_file/read_scene.hpp"
#include "tests/support/input_errors.hpp"

namespace cgcontact::test_units {
namespace {

const SourceLocation location{"scene.toml", 7, "key"};

/// A block whose values the tests replace; the file itself is never read.
Scene block(const std::vector<std::string>& overrides) {
  return parse_scene(R"(
[parameters]
d = "20 mm"
F = "500 N"
E = "210 GPa"
half = "d/2"
a = "30 deg"
n = 4

[[body]]
name = "block"
shape = {box = {min = [0, 0, 0], max = ["d", "2*d", "d + 5 mm"]}}
material = {E = "E", nu = 0.3}
cell_size = "d/n"

[[support]]
face = "block.z-"
displacement = {z = "-0.02 mm"}

[[load]]
face = "block.z+"
pressure = "F/d^2"
)",
                     "units.toml", overrides);
}

std::string message_of_block(const std::string& change) {
  return message_of([&] { block({change}); });
}

// Numbers beyond those of double precision, with a unit: a message, as without one.
TEST(Units, numbers_that_are_too_large_or_too_small) {
  for (const char* text : {"1e999 mm", "1e308 km"})
    expect_contains(message_of([&] { evaluate_constant(text, location); }), {text, "not finite"});
  EXPECT_EQ(evaluate_constant("1e-999 mm", location).value, 0);
}

TEST(Units, numbers_with_units_are_those_of_the_si_to_the_last_bit) {
  const std::pair<const char*, double> cases[] = {{"20 mm", 0.02},
                                                  {"0.02 mm", 2e-5},
                                                  {"500 N", 500},
                                                  {"210 GPa", 210e9},
                                                  {"7850 kg/m^3", 7850},
                                                  {"7.85 g/cm^3", 7850},
                                                  {"100 N/mm^2", 100e6},
                                                  {"100 N/mm\u00b2", 100e6},
                                                  {"12e-6 1/K", 12e-6},
                                                  {"1 in", 0.0254},
                                                  {"35um", 35e-6},
                                                  {"35 \u00b5m", 35e-6},
                                                  {"1.5 kN*m", 1500},
                                                  {"2 kN / m", 2000},
                                                  {"3 m^-1", 3},
                                                  {"180 deg", 3.14159265358979323846},
                                                  {"90\u00b0", 3.14159265358979323846 / 2},
                                                  {"10 m/s^2", 10},
                                                  {"-3 mm", -0.003}};
  for (const auto& [text, value] : cases) EXPECT_EQ(evaluate_constant(text, location).value, value) << text;
  EXPECT_DOUBLE_EQ(evaluate_constant("3000 rpm", location).value, 3000 * 2 * 3.14159265358979323846 / 60);
  EXPECT_DOUBLE_EQ(evaluate_constant("1 psi", location).value, 4.4482216152605 / (0.0254 * 0.0254));
}

// F/(20 mm)^2, roots and conditions have the dimension that algebra gives them.
TEST(Units, expressions_have_dimensions) {
  const Constants constants{
      {"d", evaluate_constant("20 mm", location)}, {"F", evaluate_constant("500 N", location)}, {"n", 4}};
  const auto dimension = [&](const char* text) {
    const Quantity q = evaluate_constant(text, location, constants);
    return q.dimension ? name_of(*q.dimension) : "none";
  };
  EXPECT_EQ(dimension("2*d"), "a length");
  EXPECT_EQ(dimension("d^2 + 3 mm^2"), "an area");
  EXPECT_EQ(dimension("F/20 mm^2"), "a pressure");
  EXPECT_EQ(dimension("sqrt(F/(100 MPa))"), "a length");
  EXPECT_EQ(dimension("(3*F*d/(4*210 GPa))^(1/3)"), "a length");
  EXPECT_EQ(dimension("d > 10 mm ? F : 2 N"), "a force");
  EXPECT_EQ(dimension("sin(30 deg)"), "a pure number");
  EXPECT_EQ(dimension("d/(5 mm)"), "a pure number");
  EXPECT_EQ(dimension("(3000 rpm)^2*d"), "an acceleration");
  EXPECT_EQ(dimension("0.01/n"), "none");
  EXPECT_EQ(dimension("d - d"), "none") << "zero has any dimension";
  EXPECT_DOUBLE_EQ(evaluate_constant("sin(30 deg)", location), 0.5);
  EXPECT_EQ(identifiers("20 mm*n + 5 N/mm^2*t"), (std::vector<std::string>{"n", "mm", "t"}))
      << "mm and t may be meant as parameters";
}

TEST(Units, what_does_not_fit_is_refused) {
  const Constants constants{{"d", evaluate_constant("20 mm", location)}, {"t", 3}};
  const auto message = [&](const char* text) {
    return message_of([&] { evaluate_constant(text, location, constants); });
  };
  expect_contains(message("d + 3 N"), {"scene.toml:7: key = \"d + 3 N\"", "different dimensions: a length + a force"});
  expect_contains(message("d + 0.001"),
                  {"different dimensions", "with d = 0.02", "a number without one is a pure number"});
  expect_contains(message("sqrt(1 - d)"), {"different dimensions"});
  // Whatever the values are: nothing compares a length with a force, in a branch that is not taken either.
  const std::pair<const char*, const char*> mixed[] = {
      {"1 bar*(1 m > 1 N)", "a length > a force"},
      {"1 bar*(1 km >= 1 mN)", "a length >= a force"},
      {"1 bar*(2 m == 2 N)", "a length == a force"},
      {"1 bar*(2 m != 2 N)", "a length != a force"},
      {"1 bar*(1 m > 0 N)", "a length > a force"},
      {"1 bar*(d < 1)", "a length < a pure number"},
      {"1 > 2 ? 1 m : 1 N", "a length : a force"},
      {"1 > 2 ? 1 m > 1 N : 3", "a length > a force"},
      {"d ? 1 : 2 m", "a length in place of a condition beside ?"},
      {"1 bar*(1 > 2 && 1 m)", "a length in place of a condition beside &&"},
      {"1 bar*(1 N || 2 > 1)", "a force in place of a condition beside ||"},
      {"max(1 km, 1 mN)", "a length beside a force"},
      {"min(1 mm, 3, 1 km)", "a length beside a pure number"},
      {"abs(1 m + 1 N)", "a length + a force"},
      {"sum(1 m, 2 N)", "a length beside a force"},
      {"2^(1 m)", "an exponent that is a length"},
      {"sin(1 m)", "sin of a length"},
      {"1 bar*(-(1 m) - -(2 N) > 0)", "a length - a force"}};
  for (const auto& [text, why] : mixed) expect_contains(message(text), {"different dimensions: ", why});
  const char* const fitting[] = {"1 bar*(1 m > d)",         "max(0, d - 1 mm)",   "d > 0 ? d : 0",
                                 "1 bar*(d > 1 mm && 1)",   "-d^2 + 2^-1*1 mm^2", "d^(4/2) - 1 mm^2",
                                 "sqrt(d*1 mm) + d",        "exp(-d/(1 mm))*d",   "sign(1 N)*d",
                                 "atan2(d, 1 mm)*d",        "1e-3 + d/1 m",       "sin(30 deg + 1)",
                                 "d > 1 mm == (1 N > 2 N)", "0*1 N + d",          "(d)^-.5e0*1 N"};
  for (const char* text : fitting) EXPECT_EQ(message(text), "") << text;
  expect_contains(message("20 mmm"), {"\"mmm\" is no unit (did you mean \"mm\"?)", "one of m, km, dm"});
  expect_contains(message("20 C"), {"\"C\" is no unit: temperatures are differences, in K"});
  expect_contains(message("5 N/t"), {"\"t\" is a parameter and a unit"});
  expect_contains(message_of([] { parse_scene("[parameters]\na = \"5 N/t\"\nt = 3\n", "late.toml"); }),
                  {"late.toml:2: parameters.a = \"5 N/t\": \"t\" is a parameter and a unit"});
  expect_contains(message("mm"), {"unknown name \"mm\": a unit stands behind a number"});
  EXPECT_EQ(evaluate_constant("(6 N)/t", location, constants).value, 2);
  EXPECT_EQ(evaluate_constant("5 t", location, constants).value, 5000) << "nothing but a unit stands behind a number";
}

TEST(Units, keys_take_their_dimension_and_no_other) {
  const Scene scene = block({});
  EXPECT_EQ(scene.parameters.at("d"), 0.02);
  EXPECT_EQ(scene.parameters.at("half"), 0.01);
  EXPECT_EQ(scene.bodies[0].cell_size, 0.005);
  EXPECT_EQ(scene.bodies[0].material.youngs_modulus, 210e9);
  Vec3 min, max;
  scene.bodies[0].solid.bounding_box(min, max);
  EXPECT_EQ(max, Vec3(0.02, 0.04, 0.025));
  EXPECT_EQ((*scene.supports[0].displacement[2])(Vec3::Zero()), -2e-5);
  EXPECT_DOUBLE_EQ(scene.loads[0].pressure(Vec3::Zero()), 500 / 4e-4);
  // from the command line, as a field, as a time
  EXPECT_EQ(block({"body.block.cell_size=2 mm"}).bodies[0].cell_size, 0.002);
  EXPECT_EQ(block({"d=10 mm"}).bodies[0].cell_size, 0.0025);
  EXPECT_DOUBLE_EQ(block({"load.0.pressure=100 MPa*z/d"}).loads[0].pressure(Vec3(0, 0, 0.01)), 5e7);
  EXPECT_EQ(block({"accuracy={pressure = \"1 %\", max_time = \"5 min\"}"}).accuracy.max_time, 300);
  // numbers without a unit are in SI units, degrees where the key is in degrees
  EXPECT_EQ(block({"body.block.cell_size=0.005"}).bodies[0].cell_size, 0.005);
  const auto turned = [](const char* angle) {
    return block({std::string("body.block.grid.rotation={axis = [0, 0, 1], angle = ") + angle + "}"})
        .bodies[0]
        .grid_rotation;
  };
  EXPECT_TRUE(turned("30").isApprox(turned("\"30 deg\""), 1e-15));
  EXPECT_TRUE(turned("30").isApprox(turned("\"a\""), 1e-15));
  EXPECT_TRUE(turned("90").isApprox(turned("\"pi/2*1 rad\""), 1e-15));

  expect_contains(message_of_block("body.block.cell_size=500 N"),
                  {"--set body.block.cell_size=500 N: body[0].cell_size = \"500 N\": is a force, not a length",
                   "(allowed: > 0 m; units: um, mm, cm, m, in, ft)"});
  expect_contains(message_of_block("body.block.material.E=d"), {"is a length, not a pressure", "units: Pa, kPa"});
  expect_contains(message_of_block("body.block.material.nu=d"), {"is a length, not a pure number", "no unit"});
  expect_contains(message_of_block("load.0.pressure=F*z"), {"is a moment, not a pressure"});
  expect_contains(message_of_block("load.0.pressure=1e8*z/d + F"), {"different dimensions"});
  expect_contains(message_of_block("support.0.displacement.z=20 N/mm"),
                  {"is a stiffness or force per length, not a length"});
  expect_contains(message_of_block("body.block.grid.rotation={axis = [0, 0, 1], angle = \"d\"}"),
                  {"is a length, not an angle", "deg, rad"});
  expect_contains(message_of_block("body.block.grid.rotation={axis = [0, 0, 1], angle = \"a + 5\"}"), {"not an angle"});
  expect_contains(message_of_block("body.block.cell_size=-2 mm"), {"out of range, its value is -0.002 m"});
  expect_contains(message_of_block("accuracy.max_unknowns=3 kg"), {"is a mass, not a pure number"});
}

// With the computed force in it, an expression with units is checked too; one without is not.
TEST(Units, of_a_reference_with_the_contact_force) {
  const auto reference = [](const std::string& pressure) {
    return message_of([&] {
      block(
          {"body=[{name = \"block\", shape = {box = {min = [0, 0, 0], max = [1, 1, 1]}}, material = {E = 1, nu = 0}, "
           "cell_size = 0.5}, {name = \"upper\", shape = {box = {min = [0, 0, 1], max = [1, 1, 2]}}, material = {E = "
           "1, nu = 0}, cell_size = 0.5}]",
           "contact=[{faces = [\"block.z+\", \"upper.z-\"]}]", "reference.pressure=" + pressure});
    });
  };
  EXPECT_EQ(reference("contact_force/1 mm^2"), "");
  EXPECT_EQ(reference("contact_force/3"), "");
  expect_contains(reference("contact_force/1 mm"), {"is a stiffness or force per length, not a pressure"});
}

}  // namespace
}  // namespace cgcontact::test_units
