/// What is no prism one layer of cells thick, or acts on its ends or along it; sums around an axis of revolution.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "contact/model/around_axis.hpp"
#include "contact/model/plane_strain.hpp"
#include "contact/preparation.hpp"
#include "core/scene_file/read_scene.hpp"
#include "tests/support/input_errors.hpp"
#include "tests/support/scene_text.hpp"

namespace cgcontact::test_plane_strain_checks {
namespace {

/// Makes a body in plane strain across y, its solid between two planes.
BodySpec prism(const std::string& name, double low, double high) {
  BodySpec body;
  body.name = name;
  body.solid = Solid::box(Vec3(0.2, low, -0.3), Vec3(1.2, high, 0.4), "box");
  body.plane_strain = Coordinate::y;
  body.plane_strain_location = {"scene.toml", 3, "plane_strain"};
  body.cell_size = 0.1;
  body.grid_offset = Vec3(0.9, 0.3, 0.9);
  return body;
}

/// A vector of the half-plane turns with it: its mean over all turns is what is left of the sum, and the moment of a
/// force about the origin has the mean zero. The reader sets the axis across to the one before the axis of revolution.
TEST(SumAroundAxis, IsTheMeanOverAllTurns) {
  for (int along = 0; along < 3; ++along) {
    BodySpec body;
    body.plane_strain = static_cast<Coordinate>((along + 2) % 3);
    body.unit_radius = 0.7;
    const Vec3 axis = Vec3::Unit(along), radius = Vec3::Unit((along + 1) % 3);
    const Vec3 x = 0.3 * radius + 2 * axis, f = -5 * radius + 7 * axis;
    Vec3 mean = Vec3::Zero(), mean_moment = Vec3::Zero();
    constexpr int turns = 12;
    for (int k = 0; k < turns; ++k) {
      const Mat3 turn = Eigen::AngleAxisd(2 * pi * k / turns, axis).toRotationMatrix();
      mean += turn * f / turns;
      mean_moment += (turn * x).cross(turn * f) / turns;
    }
    Vec3 force = f, alone = f, moment = x.cross(f);
    sum_around_axis(body, force, &moment);
    sum_around_axis(body, alone);
    const double rounding = 1e-14 * x.norm() * f.norm();  // of twelve terms
    EXPECT_LT((force - mean).norm(), rounding) << along;
    EXPECT_LT((moment - mean_moment).norm(), rounding) << along;
    EXPECT_EQ(alone, force);
  }
}

TEST(SumAroundAxis, LeavesOtherBodiesAlone) {
  Vec3 force(1, 2, 3), moment(4, 5, 6);
  sum_around_axis(prism("slab", 0, 0.06), force, &moment);
  EXPECT_EQ(force, Vec3(1, 2, 3));
  EXPECT_EQ(moment, Vec3(4, 5, 6));
}

/// Cells of 0.1 m that begin 0.3 cells before the body hold between a half and 0.7 cells of it. The offsets along the
/// other axes do not matter.
TEST(PlaneStrainChecks, ThicknessFillsHalfALayerAndNoMore) {
  const BodySpec body = prism("slab", 0, 0.06);
  for (const double thickness : {0.05, 0.06, 0.07}) EXPECT_NO_THROW(check_thickness(body, thickness)) << thickness;
  expect_contains(message_of([&] { check_thickness(body, 0.0701); }),
                  {"scene.toml:3: plane_strain = \"y\"", "\"slab\"", "0.0701 m thick", "0.701 of its cells",
                   "0.3 cells before it", "a thickness of 0.05 to 0.07 m"});
  expect_contains(message_of([&] { check_thickness(body, 0.0499); }), {"0.0499 m thick", "0.05 to 0.07 m"});
}

/// Ends that are off by single precision (2e-7 m at 2 m) are the same ones, those that are off by 1e-5 m are not, on
/// either side; bodies on cells of one size may be as thick as they like.
TEST(PlaneStrainChecks, SlicesLieBetweenTheSamePlanes) {
  const auto refusal = [](double low, double high, bool quadtree, bool flat) {
    Scene scene;
    scene.bodies = {prism("one", 2, 2.06), prism("other", low, high)};
    for (BodySpec& body : scene.bodies) body.quadtree = quadtree;
    if (!flat) scene.bodies[1].plane_strain.reset();
    return message_of([&] { check_slices(scene); });
  };
  EXPECT_EQ(refusal(2, 2.06, true, true), "");
  EXPECT_EQ(refusal(2 + 2e-7, 2.06 - 2e-7, true, true), "");
  EXPECT_EQ(refusal(1, 3, false, true), "");
  expect_contains(refusal(2, 2.06001, true, true),
                  {"body \"other\": it lies between 2 and 2.06001 m", "\"one\" between 2 and 2.06 m", "the same ends"});
  expect_contains(refusal(1.9999, 2.06, true, true), {"it lies between 1.9999 and 2.06 m"});
  expect_contains(refusal(2, 2.06, true, false),
                  {"scene.toml:3", "\"other\" is not in plane strain", "for all bodies"});
}

/// The ends move to where they are asked for, the section stays: to the rounding of coordinates of 2 m stretched 75
/// times.
TEST(PlaneStrainChecks, StretchingMovesTheEndsOnly) {
  const BodySpec body = prism("slab", 2, 2.06);
  const Solid hole = Solid::cylinder(Vec3(0.5, 1, 0), Vec3(0.5, 3, 0), 0.2, "hole");
  for (const Solid& solid : {body.solid, Solid::subtract(body.solid, hole)}) {
    Vec3 min, max;
    ASSERT_TRUE(stretched_to(body, solid, -1.5, 3).bounding_box(min, max));
    EXPECT_LT((min - Vec3(0.2, -1.5, -0.3)).norm(), 1e-12);
    EXPECT_LT((max - Vec3(1.2, 3, 0.4)).norm(), 1e-12);
  }
  const Solid ball = Solid::sphere(Vec3(0.5, 2.03, 0), 0.02, "ball");
  expect_contains(
      message_of([&] { stretched_to(body, ball, 0, 1); }),
      {"scene.toml:3: plane_strain = \"y\"", "body \"slab\"", "ball.surface", "a prism between two planes"});
}

/// Boundary of a prism across y from 0.2 to 0.8 of a layer; a test adds one point to it, or a cell.
CutCells layer() {
  CutCells cells;
  cells.grid.cell_size = 0.1;
  cells.grid.origin = Vec3(1, 2, 3);
  cells.cells = {{4, 7, 5}, {4, 7, 6}};
  for (const double x : {4.1, 4.6}) {
    cells.boundary.append(Vec3(x, 7.2, 5.5), -Vec3::UnitY(), 1, 0, 0);
    cells.boundary.append(Vec3(x, 7.8, 5.5), Vec3::UnitY(), 1, 0, 1);
    cells.boundary.append(Vec3(x, 7.5, 5.1), Vec3(0.6, 0, -0.8), 1, 0, 2);
  }
  return cells;
}

/// Facets of triangle surfaces are off by single precision; 1e-3 is the limit for normals and for positions in cells.
TEST(PlaneStrainChecks, BoundaryIsTwoEndsAndSidesAlongTheAxis) {
  const BodySpec body = prism("slab", 2.72, 2.78);
  const auto refusal = [&](const Vec3& x, const Vec3& n) {
    CutCells cells = layer();
    cells.boundary.append(x, n.normalized(), 1, 1, 3);
    return message_of([&] { check_extruded(body, cells); });
  };
  EXPECT_EQ(message_of([&] { check_extruded(body, layer()); }), "");
  EXPECT_EQ(refusal(Vec3(4.5, 7.5, 5.2), Vec3(0, 5e-4, 1)), "");
  EXPECT_EQ(refusal(Vec3(4.5, 7.7995, 5.2), Vec3::UnitY()), "");
  const std::vector<std::string> expected{"neither an end nor along the axis", "at (1.45, 2.7", "a prism between"};
  expect_contains(refusal(Vec3(4.5, 7.5, 5.2), Vec3(0, 2e-3, 1)), expected);  // a side that leans
  expect_contains(refusal(Vec3(4.5, 7.5, 5.2), Vec3(0, 1, 1)), expected);     // a chamfer
  expect_contains(refusal(Vec3(4.5, 7.5, 5.2), Vec3::UnitY()), expected);     // a step
  expect_contains(refusal(Vec3(4.5, 7.75, 5.2), -Vec3::UnitY()), expected);   // a groove
  expect_contains(refusal(Vec3(4.5, 7.798, 5.2), Vec3::UnitY()), expected);   // a step of two thousandths
  CutCells two_layers = layer();
  two_layers.cells.push_back({4, 8, 5});
  expect_contains(message_of([&] { check_extruded(body, two_layers); }),
                  {"in more than one layer of cells", "another grid.offset"});
}

/// Contact on the ends is named as what it is, not as a support of the scene: named, automatic and bonded.
TEST(PlaneStrainChecks, ContactOnAnEndIsRefused) {
  const std::string text = "plane_strain = \"x\"\n" + test::box_text("lower", "[0, 0, 0]", "[0.1, 1, 0.6]", 0.13) +
                           test::box_text("upper", "[0.1, 0, 0]", "[0.2, 1, 0.6]", 0.13) +
                           test::symmetry_text({"lower.y-", "lower.z-", "upper.y-", "upper.z-"});
  const std::string named = test::contact_text("lower.x+", "upper.x-");
  for (const std::string& contact : {named, named + "bonded = true\n", std::string("[[contact]]\nautomatic = true\n")})
    expect_contains(message_of([&] { prepare(parse_scene(text + contact, "scene.toml")); }),
                    {"\"lower-upper\": presses body \"", "\" along x, across which it is in plane strain, at (0.1, ",
                     "contact of the sides only"});
}

/// The rest of what varies around an axis of revolution (test_axisymmetric.cpp has the other half), and what does not.
TEST(PlaneStrainChecks, BodiesOfRevolutionAreLoadedAlikeAllAround) {
  const auto refusal = [](const std::string& first, const std::string& more, const std::string& last) {
    return message_of([&] {
      prepare(parse_scene(first + R"(
axisymmetric = "z"
[[body]]
name = "rod"
shape = {name = "rod", cylinder = {base = [0, 0, 0], top = [0, 0, 0.03], radius = 0.02}}
material = {E = 200e9, nu = 0.3, density = 7850}
cell_size = 0.0041
)" + more + test::support_text("rod.rod.bottom", "displacement = {z = 0}") +
                              last,
                          "scene.toml"));
    });
  };
  const std::string top = "[[load]]\nface = \"rod.rod.top\"\n";
  EXPECT_EQ(refusal("gravity = [0, 0, -9.81]\nrotation = {axis = [0, 0, -2], speed = 10}\n",
                    "body_force = [\"1e5*x\", 0, 2e5]\n", top + "force = [0, 0, 100]\n"),
            "");
  expect_contains(refusal("rotation = {axis = [0, 0, 1], speed = 10, centre = [0.001, 0, 0]}\n", "", ""),
                  {"\"rod\": it rotates about another axis than that of revolution", "rotation about z"});
  expect_contains(refusal("", "body_force = [0, 1e5, 0]\n", ""),
                  {"\"rod\": the force on its volume acts around its axis of revolution", "none around it"});
  expect_contains(refusal("", "", top + "force = [0, 1, 100]\n"), {"\"rod.rod.top\"", "a force along z"});
  expect_contains(refusal("", "", test::support_text("rod.rod.top", "displacement = {y = 1e-6}")),
                  {"\"rod.rod.top\": turns a body of revolution about its axis", "no displacement along y, or 0"});
}

}  // namespace
}  // namespace cgcontact::test_plane_strain_checks
