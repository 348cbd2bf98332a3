/// Supports about an axis, springs to the ground and rotated faces, held to states that the elements have exactly.
#include <gtest/gtest.h>

#include <algorithm>

#include "contact/model/held_directions.hpp"
#include "contact/preparation.hpp"
#include "core/base/errors/errors.hpp"
#include "core/scene/face_traction.hpp"
#include "tests/support/input_errors.hpp"
#include "tests/support/run_scene.hpp"

namespace cgcontact::test_supports {
namespace {

constexpr double E = 200e9, nu = 0.3;

/// A stress and a displacement everywhere.
template <class Stress, class Displacement>
void expect(const Results& r, const Stress& stress, double stress_tolerance, const Displacement& u, double tolerance) {
  ASSERT_TRUE(r.converged) << r.diagnosis;
  const test::Differences found = test::differences(r, stress, u);
  EXPECT_LT(std::max(found.raw, found.recovered), stress_tolerance);
  EXPECT_LT(found.displacement, tolerance);
}

/// A cylinder of radius 0.3 m about (0.1, 0.2), 0.5 m high, on a grid that does not fit it.
std::string cylinder(const std::string& more, const std::string& grid) {
  return R"(
[[body]]
name = "rod"
shape = {cylinder = {base = [0.1, 0.2, 0], top = [0.1, 0.2, 0.5], radius = 0.3}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.11
grid = )" +
         grid + "\n" + more;
}
const std::string turned = "{offset = [0.3, 0.6, 0.2], rotation = {axis = [1, 2, 3], angle = 20}}";

/// Widened by the same strain everywhere: sigma_r = sigma_theta = E e/(1 - nu), the length shrinks by 2 nu e/(1 - nu).
TEST(CylindricalSupport, WidensACylinderExactly) {
  const double e = 1e-4;
  const auto solved = test::run_text(cylinder(R"(
[[support]]
face = "rod.side"
cylindrical = {radial = "0.3*1e-4", tangential = 0}
[[support]]
face = "rod.bottom"
cylindrical = {axial = 0, point = [7, 8, 9], axis = [0, 0, 3]}
)",
                                              turned));
  Sym3 stress = Sym3::Zero();
  stress[0] = stress[1] = E * e / (1 - nu);
  expect(
      solved->results(), [&](const Vec3&) { return stress; }, 1e-10 * E * e,
      [&](const Vec3& x) { return Vec3(e * (x[0] - 0.1), e * (x[1] - 0.2), -2 * nu * e / (1 - nu) * x[2]); },
      1e-10 * e);
  EXPECT_EQ(solved->results().supports[0].condition, "radial = 30 um, tangential = 0");
  EXPECT_EQ(solved->results().supports[1].condition, "axial = 0");
}

/// The side as a bushing: what is held is the radial direction alone, the rod turns and slides in it without stress.
TEST(CylindricalSupport, LetsARodTurnAndSlide) {
  const auto solved = test::run_text(cylinder(R"scene(
[[support]]
face = "rod.side"
cylindrical = {radial = 0}
[[support]]
face = "rod.top"
cylindrical = {tangential = "1e-4*sqrt((x-0.1)^2+(y-0.2)^2)", axial = 2e-5, point = [0.1, 0.2, 0], axis = [0, 0, 1]}
)scene",
                                              turned),
                                     test::tight_without_forces);
  expect(
      solved->results(), [&](const Vec3&) { return Sym3(Sym3::Zero()); }, 1e-10 * E * 1e-4,
      [&](const Vec3& x) { return Vec3(-1e-4 * (x[1] - 0.2), 1e-4 * (x[0] - 0.1), 2e-5); }, 1e-13);
}

/// Torsion of a round bar, u = theta z/L (-y, x, 0): the elements of a grid along the axes have it exactly, cut or not.
/// The moment is G J theta/L.
TEST(RotatedFace, TwistsARoundBarExactly) {
  const double degrees = 0.01, theta = degrees * pi / 180, L = 0.5, G = E / (2 * (1 + nu));
  const auto solved = test::run_text(cylinder(R"(
[[support]]
face = "rod.bottom"
displacement = {x = 0, y = 0, z = 0}
[[support]]
face = "rod.top"
rotation = {axis = [0, 0, 2], angle = 0.01, centre = [0.1, 0.2, 5]}
)",
                                              "{offset = [0.3, 0.6, 0.2]}"));
  const double scale = G * theta / L * 0.3;
  const auto stress = [&](const Vec3& x) {
    Sym3 s = Sym3::Zero();
    s[4] = G * theta / L * (x[0] - 0.1);
    s[5] = -G * theta / L * (x[1] - 0.2);
    return s;
  };
  const auto u = [&](const Vec3& x) {
    return Vec3(-theta * x[2] / L * (x[1] - 0.2), theta * x[2] / L * (x[0] - 0.1), 0);
  };
  expect(solved->results(), stress, 1e-9 * scale, u, 1e-10 * theta);
  double moment = 0;
  const SolvedState& state = solved->simulation->state;
  for (std::size_t s = 0; s < state.supports.size(); ++s) {
    const SupportPoint& p = state.supports[s];
    if (p.support != 1) continue;
    const Vec3 x = global_position(state.bodies[0].cut_cells, p.cell, p.xi) - Vec3(0.1, 0.2, 0);
    moment += x.cross(p.weight * state.outer.support_stress[s] * p.direction)[2];
  }
  EXPECT_NEAR(moment / (G * pi * std::pow(0.3, 4) / 2 * theta / L), 1, 1e-9);
}

/// Radial, tangential and axial are right-handed about the axis that the scene gives, with their values at the point;
/// springs of a whole face are shared out over its area (a round one, integrated to 1e-9).
TEST(HeldDirections, AreThoseOfThePointAndOfTheFace) {
  const Scene scene = parse_scene(cylinder(R"(
[[support]]
face = "rod.side"
cylindrical = {radial = "1e-4*x", tangential = 2e-4, axial = 3e-4, point = [0.1, 0.2, 9], axis = [0, 0, 2]}
[[support]]
face = "rod.bottom"
spring = 5e8
[[support]]
face = "rod.top"
displacement = {x = 1e-5, z = "y", normal = 4e-5}
)",
                                           turned),
                                  "scene.toml");
  const Preparation p = discretise(scene);
  const double c = std::cos(0.7), s = std::sin(0.7);
  const Vec3 x(0.1 + 0.3 * c, 0.2 + 0.3 * s, 0.1), n(c, s, 0);
  const auto held = [&](int support, const Vec3& normal) { return held_at(scene, p.bodies[0], support, x, normal); };
  const auto expect_held = [](const HeldDirection& h, Held component, const Vec3& direction, double value,
                              double stiffness) {
    EXPECT_EQ(h.component, component);
    EXPECT_LT((h.direction - direction).norm(), 1e-14);
    EXPECT_NEAR(h.value, value, 1e-16);
    EXPECT_NEAR(h.stiffness, stiffness, 1e-8 * stiffness);
  };
  const std::vector<HeldDirection> side = held(0, n), bottom = held(1, -Vec3::UnitZ()), top = held(2, Vec3::UnitZ());
  ASSERT_EQ(side.size(), 3u);
  expect_held(side[0], Held::radial, n, 1e-4 * x[0], 0);
  expect_held(side[1], Held::tangential, Vec3(-s, c, 0), 2e-4, 0);
  expect_held(side[2], Held::axial, Vec3::UnitZ(), 3e-4, 0);
  ASSERT_EQ(bottom.size(), 1u);
  expect_held(bottom[0], Held::normal, -Vec3::UnitZ(), 0, 5e8 / (pi * 0.09));
  ASSERT_EQ(top.size(), 3u);
  expect_held(top[0], Held::normal, Vec3::UnitZ(), 4e-5, 0);
  expect_held(top[1], Held::x, Vec3::UnitX(), 1e-5, 0);
  expect_held(top[2], Held::z, Vec3::UnitZ(), x[1], 0);
}

/// A block of 0.5 x 0.4 x 1 m on springs.
std::string block(const std::string& more) {
  return R"(
[[body]]
name = "block"
shape = {box = {min = [0, 0, 0], max = [0.5, 0.4, 1]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.13
grid = )" +
         turned + "\n" + more;
}

/// p/k under it, p/E in it; the same with springs of the whole face, and their reaction is the load.
TEST(Springs, CarryABlockExactly) {
  for (const char* springs : {"stiffness = 2e9", "spring = 0.4e9", "stiffness = [0, 0, \"2 GPa/m\"]"}) {
    const auto solved = test::run_text(block(std::string("[[support]]\nface = \"block.z-\"\n") + springs + R"(
[[support]]
face = "block.x-"
symmetry = true
[[support]]
face = "block.y-"
symmetry = true
[[load]]
face = "block.z+"
pressure = 1e6
)"),
                                       test::tight_without_forces);  // springs are no supports whose stress is lagged
    const double p = 1e6, k = 2e9;
    expect(
        solved->results(), [&](const Vec3&) { return Sym3(-p * Sym3::Unit(2)); }, 1e-9 * p,
        [&](const Vec3& x) { return Vec3(nu * p / E * x[0], nu * p / E * x[1], -p / k - p / E * x[2]); },
        1e-10 * p / k);
    EXPECT_NEAR(solved->results().supports[0].force[2] / (p * 0.2), 1, 1e-9);
    EXPECT_EQ(
        solved->results().supports[0].condition,
        std::string("springs along ") + (springs[0] == 's' && springs[12] == '[' ? "z" : "normal") + " 2e+09 N/m^3");
  }
}

/// A force through the springs' face moves the block by f/k in every direction, without stress.
TEST(Springs, OfThreeDirectionsMoveABlockWithoutStress) {
  const auto solved = test::run_text(block(R"(
[[support]]
face = "block.z-"
stiffness = [1e9, 2e9, 4e9]
[[load]]
face = "block.z-"
force = [2e5, 2e5, 2e5]
)"));
  const double t = 1e6;
  expect(
      solved->results(), [&](const Vec3&) { return Sym3(Sym3::Zero()); }, 1e-8 * t,
      [&](const Vec3&) { return Vec3(t / 1e9, t / 2e9, t / 4e9); }, 1e-10 * t / 1e9);
}

/// What is held twice, as a whole face, in another way or on a part of it, is held once: a bar under its pressure keeps
/// its exact state, on cells that do not fit it. The first support takes the reaction, a warning names the others.
TEST(Supports, RepeatedOnesHoldOnce) {
  const std::string bar = R"(
[[body]]
name = "bar"
shape = {box = {min = [0, 0, 0], max = [0.1, 0.1, 0.3]}}
material = {E = 200e9, nu = 0}
cell_size = 0.03
grid = {offset = [0.3, 0.2, 0.4]}
faces = [{name = "part", surfaces = ["box.z-"], box = {min = [-1, -1, -1], max = [0.04, 1, 1]}}]
[[support]]
face = "bar.z-"
displacement = {x = 0, y = 0, z = 0}
[[load]]
face = "bar.z+"
pressure = 1e6
)";
  for (const std::string again :
       {"face = \"bar.z-\"\nsymmetry = true", "face = \"bar.z-\"\ndisplacement = {x = 0, y = 0, z = 0}",
        "face = \"bar.part\"\ndisplacement = {normal = 0}", "face = \"bar.z-\"\ndisplacement = {z = 0, normal = 0}"}) {
    const auto solved = test::run_text(bar + "[[support]]\n" + again + "\n");
    const Results& results = solved->results();
    expect(
        results, [&](const Vec3&) { return Sym3(-1e6 * Sym3::Unit(2)); }, 1e-7 * 1e6,
        [&](const Vec3& x) { return Vec3(0, 0, -1e6 / 200e9 * x[2]); }, 1e-8 * 1e6 / 200e9);
    EXPECT_NEAR(results.supports[0].force[2], 1e4, 1e-4) << again;
    EXPECT_NEAR(results.supports[1].force.norm(), 0, 1e-4) << again;
    const auto told = [](const std::string& text) { return text.find("repeats directions") != std::string::npos; };
    EXPECT_TRUE(std::any_of(results.warnings.begin(), results.warnings.end(), told)) << again;
  }
}

/// What the axis of a face is: of a cylinder also from facets and from a region of it; of other faces there is none.
TEST(FaceMoments, FindTheAxisOfACylinder) {
  const auto around = [](int facets, double turn, int inside) {
    FaceMoments moments;
    const Mat3 R = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (int f = 0; f < facets; ++f)
      for (int i = 0; i < inside; ++i)
        for (int k = 0; k < 5; ++k) {
          const double middle = turn * (f + 0.5) / facets, half = turn / (2 * facets);
          const Vec3 n(std::cos(middle), std::sin(middle), 0), t(-n[1], n[0], 0);
          const Vec3 x = 0.3 * (n + std::tan(half) * ((2.0 * i + 1) / inside - 1) * t) + Vec3(0, 0, 0.2 * k);
          moments.add(Vec3(100, 50, 20) + R * x, R * n, 1);
        }
    return std::make_pair(moments.axis(), Vec3(R.col(2)));
  };
  for (const auto& [facets, turn, inside] :
       {std::tuple(200, 2 * pi, 1), std::tuple(40, 1.0, 1), std::tuple(12, 2 * pi, 4), std::tuple(10, pi / 2, 3)}) {
    const auto [axis, direction] = around(facets, turn, inside);
    ASSERT_TRUE(axis) << facets;
    EXPECT_NEAR(std::abs(axis->direction.dot(direction)), 1, 1e-9);
    const Vec3 r = axis->point - Vec3(100, 50, 20);
    EXPECT_LT((r - r.dot(direction) * direction).norm(), inside == 1 ? 1e-7 : 0.01) << facets;
  }
  EXPECT_FALSE(around(4, 2 * pi, 10).first) << "the sides of a square";
  FaceMoments plane;
  for (int i = 0; i < 9; ++i) plane.add(Vec3(i % 3, i / 3, 0), Vec3::UnitZ(), 1);
  EXPECT_FALSE(plane.axis());
}

/// A line of points in plane strain carries a moment about the axis, wherever along it a force acts; none about others.
TEST(FaceMoments, OfALineInPlaneStrain) {
  FaceMoments line(2), of_space;
  for (int i = 0; i <= 10; ++i)
    for (FaceMoments* moments : {&line, &of_space}) moments->add(Vec3(0.01 * i, 0.5, 0.002), Vec3::UnitY(), 1e-4);
  const Vec3 force(3, -1000, 0), moment(0, 0, 2);
  for (const double z : {0.002, 0.0, 0.7}) {
    const FaceTraction traction = line.with_resultants(force, moment, Vec3(0.08, 0.5, z));
    Vec3 sum = Vec3::Zero();
    double about_middle = 0;
    for (int i = 0; i <= 10; ++i) {
      const Vec3 x(0.01 * i, 0.5, 0.002), f = 1e-4 * traction.at(x, Vec3::UnitY());
      sum += f;
      about_middle += (x - Vec3(0.05, 0.5, 0.002)).cross(f)[2];
    }
    EXPECT_LT((sum - force).norm(), 1e-12 * force.norm());
    EXPECT_NEAR(about_middle, 2 + 0.03 * -1000, 1e-12 * 30) << z;
  }
  EXPECT_THROW(line.with_resultants(force, Vec3(1, 0, 2), Vec3::Zero()), InputError);
  EXPECT_THROW(of_space.with_resultants(force, moment, Vec3(0.08, 0.5, 0)), InputError);
}

/// A block above a roller that is held by its side. `roller`: its material.
std::string block_on_roller(const std::string& roller, const std::string& held, const std::string& more) {
  return R"(
[[body]]
name = "block"
material = {E = 200e9, nu = 0.3}
cell_size = 0.0021
shape = {box = {min = [0, 0, 0], max = [0.005, 0.01, 0.01]}}
[[body]]
name = "roller"
cell_size = 0.0023
)" + roller +
         R"(
shape = {cylinder = {base = [0, 0, -0.01], top = [0.005, 0, -0.01], radius = 0.01}}
faces = [{name = "low", surfaces = ["cylinder.side"], box = {min = [-1, -1, -1], max = [1, 1, -0.012]}}]
[[support]]
face = "block.y-"
symmetry = true
[[support]]
face = "block.x-"
symmetry = true
[[load]]
face = "block.z+"
force = [0, 0, -1000]
[[contact]]
faces = ["block.z-", "roller.side"]
[[support]]
)" + held +
         more;
}

/// On a curved face whatever does not lie in the face holds its normal: alone, two together, radially, by springs.
TEST(Supports, AreRefusedOnACurvedFaceOfContact) {
  for (const char* roller : {"rigid = true", "material = {E = 200e9, nu = 0.3}"}) {
    for (const char* held :
         {"face = \"roller.side\"\ndisplacement = {x = 0, y = 0, z = 0}\n",
          "face = \"roller.side\"\ndisplacement = {y = 0, z = 0}\n", "face = \"roller.side\"\ndisplacement = {y = 0}\n",
          "face = \"roller.side\"\ndisplacement = {normal = 0}\n",
          "face = \"roller.side\"\ncylindrical = {radial = 0, tangential = 0}\n",
          "face = \"roller.side\"\nstiffness = [0, 0, 1e12]\n"})
      expect_contains(message_of([&] { test::run_text(block_on_roller(roller, held, "")); }),
                      {"\"roller.side\"", "of a face of contact", "along its normal", "box = {..}"});
  }
}

/// An automatic pair finds the held face itself: no result is given then.
TEST(Supports, UnderAutomaticContactAreNoResult) {
  std::string text =
      block_on_roller("rigid = true", "face = \"roller.side\"\ndisplacement = {x = 0, y = 0, z = 0}\n", "");
  const std::string named = "faces = [\"block.z-\", \"roller.side\"]";
  text.replace(text.find(named), named.size(), "automatic = true");
  const auto solved = test::run_text(text, {});
  EXPECT_FALSE(solved->results().converged);
  expect_contains(solved->results().verdict.text, {"whose normal a support holds", "block-roller"});
}

/// The region of the side away from the contact may be held: the force of the load goes through the contact.
TEST(Supports, HoldAPartOfACurvedFace) {
  const auto solved = test::run_text(
      block_on_roller("rigid = true", "face = \"roller.low\"\ndisplacement = {x = 0, y = 0, z = 0}\n", ""), {});
  ASSERT_TRUE(solved->results().converged) << solved->results().diagnosis;
  EXPECT_NEAR(solved->results().pairs[0].force_on_first[2], 1000, 1);
  EXPECT_GT(solved->results().pairs[0].max_pressure, 0);
}

/// A cantilever under a force at its end: the moment of its support is that of the force about the held face's
/// centroid.
TEST(Supports, TellTheirMoments) {
  const auto solved = test::run_text(R"(
[[body]]
name = "beam"
shape = {box = {min = [0, 0, 0], max = [0.5, 0.1, 0.06]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.043
grid = {offset = [0.3, 0.6, 0.2], rotation = {axis = [1, 2, 3], angle = 20}}
[[support]]
face = "beam.x-"
displacement = {x = 0, y = 0, z = 0}
[[load]]
face = "beam.x+"
force = [100, 200, -300]
)");
  ASSERT_TRUE(solved->results().converged) << solved->results().diagnosis;
  const SupportFigures& support = solved->results().supports[0];
  EXPECT_LT((support.about - Vec3(0, 0.05, 0.03)).norm(), 1e-12);
  const Vec3 expected = -Vec3(0.5, 0, 0).cross(Vec3(100, 200, -300));
  EXPECT_LT((support.moment - expected).norm(), 1e-8 * expected.norm());
}

}  // namespace
}  // namespace cgcontact::test_supports
