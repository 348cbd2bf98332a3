/// Scenes in plane strain: as slabs between symmetry planes, without them; what contradicts plane strain is refused.
#include <gtest/gtest.h>

#include <fstream>
#include <numeric>
#include <regex>
#include <sstream>

#include "contact/preparation.hpp"
#include "contact/simulation.hpp"
#include "core/scene_file/read_scene.hpp"

namespace cgcontact::test_plane_strain {
namespace {

std::string file_of(const std::string& name) { return std::string(CGCONTACT_SOURCE_DIR) + "/scenes/" + name; }

std::string text_of(const std::string& name) {
  std::stringstream text;
  text << std::ifstream(file_of(name)).rdbuf();
  return text.str();
}

/// The scene without the supports across the axis, with the key instead.
std::string in_plane_strain(const std::string& text, const std::string& axis) {
  const std::regex support(R"re(\[\[support\]\]\nface = "[^"]*\.)re" + axis + R"re([-+]"\nsymmetry = true\n)re");
  const std::string rest = std::regex_replace(text, support, "");
  EXPECT_NE(rest, text);
  return "plane_strain = \"" + axis + "\"\n" + rest;
}

struct Solved {
  Scene scene;
  std::unique_ptr<Simulation> simulation;
  const Results& results() const { return simulation->results; }
};

Solved read(const std::string& text, const std::string& name, const std::vector<std::string>& overrides) {
  std::vector<std::string> all{"solver.tolerance=1e-10", "solver.linear_tolerance=1e-14"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  return {parse_scene(text, file_of(name), all), nullptr};
}

void run(Solved& solved) {
  solved.simulation = std::make_unique<Simulation>(solved.scene);
  solved.simulation->run({});
  ASSERT_TRUE(solved.results().converged) << solved.results().diagnosis;
}

/// Tells whether the contact ends so near to a row that patches for the stress there have cells at the end.
bool is_beside_end(const std::vector<ContactRow>& rows, const ContactRow& row) {
  return std::any_of(rows.begin(), rows.end(), [&](const ContactRow& other) {
    return other.body == row.body && other.active != row.active && (other.x - row.x).norm() < 2 * row.larger_cell;
  });
}

/// What is compared: the force; on the contact faces the recovered pressures, and the stresses away from the end of
/// the contact and those beside it.
std::vector<std::vector<double>> figures(const Results& results) {
  const Vec3 force = results.pairs[0].force_on_first;
  std::vector<std::vector<double>> all{{force[0], force[1], force[2]}, {}, {}, {}};
  for (const ContactRow& row : results.contact_rows) {
    all[1].insert(all[1].end(), {row.pressure_spr, row.pressure_sprc});
    std::vector<double>& stress = all[is_beside_end(results.contact_rows, row) ? 3 : 2];
    for (int k = 0; k < 6; ++k) stress.insert(stress.end(), {row.stress_spr[k], row.stress_sprc[k]});
  }
  return all;
}

/// The symmetry planes of a slab hold with kappa E/h against the difference of recovered and finite elements' stress:
/// they give way by the discretisation's error over kappa. The differences from the slab fall like 1 / kappa, and what
/// remains of them for infinite kappa (extrapolated from two) is zero.
TEST(PlaneStrain, IsTheSlabBetweenRigidPlanes) {
  struct Case {
    const char *name, *axis;
    std::vector<std::string> overrides;
  };
  // Both bodies as thick as a cell: otherwise the ghost penalty, which does not end where the body does, sets the
  // slab's two layers of nodes apart.
  for (const Case& c : {Case{"two_solids.toml", "x", {"body.0.cell_size=0.01/(1.3*n)", "body.0.grid.offset.0=0"}},
                        Case{"rings.toml", "z", {"body.0.cell_size=c/(1.3*n)", "body.0.grid.offset.2=0"}}}) {
    const std::string slab = text_of(c.name), shared = in_plane_strain(slab, c.axis);
    const double factor[2] = {1e3, 1e4};  // of kappa = 10
    std::vector<std::vector<double>> difference[2];
    for (int k = 0; k < 2; ++k) {
      Solved with = read(shared, c.name, c.overrides), without = read(slab, c.name, c.overrides);
      for (Solved* solved : {&with, &without}) {
        solved->scene.solver.thin_kappa_factor = factor[k];
        run(*solved);
      }
      EXPECT_EQ(3 * with.results().unknowns, without.results().unknowns);
      EXPECT_EQ(with.results().active_points, without.results().active_points);
      difference[k] = figures(with.results());
      const std::vector<std::vector<double>> other = figures(without.results());
      const auto largest_of = [&](std::size_t kind) {
        return std::accumulate(other[kind].begin(), other[kind].end(), 0.0,
                               [](double most, double value) { return std::max(most, std::abs(value)); });
      };
      for (std::size_t kind = 0; kind < other.size(); ++kind) {
        const double largest = kind < 2 ? largest_of(kind) : std::max(largest_of(2), largest_of(3));
        ASSERT_EQ(difference[k][kind].size(), other[kind].size());
        for (std::size_t i = 0; i < other[kind].size(); ++i)
          difference[k][kind][i] = (difference[k][kind][i] - other[kind][i]) / largest;
      }
    }
    // Relative to the largest value; at kappa = 1e4 they are 1e-8 to 3e-6. The recovered stress has the
    // pressures of two problems on the face, a strip and a sum over the twelve nearest periods of the slab, which
    // differ by some 1e-8. The edge of the contact, fitted to the few patches beside it, differs by some 1e-6 of a
    // cell; the stress grows like the root of the distance from there, which is a fifteenth of a cell for the nearest
    // points: eight times that, of a fifth of the largest stress. Two cells farther away a tenth of it is left
    // (rounding alone, which moves the fitted edge, makes it 1e-8 or 1.2e-7).
    const double allowed[4] = {1e-10, 1e-8, 2e-7, 2e-6};
    for (int kind = 0; kind < 4; ++kind) {
      double size[2] = {0, 0}, left = 0;
      for (std::size_t i = 0; i < difference[0][kind].size(); ++i) {
        const double d[2] = {difference[0][kind][i], difference[1][kind][i]};
        for (int k = 0; k < 2; ++k) size[k] = std::max(size[k], std::abs(d[k]));
        left = std::max(left, std::abs(factor[1] * d[1] - factor[0] * d[0]) / (factor[1] - factor[0]));
      }
      std::printf("%s, %d: difference %.1e at kappa = 1e4, %.1e at 1e5, %.1e extrapolated\n", c.name, kind, size[0],
                  size[1], left);
      EXPECT_LT(size[1], 0.12 * size[0] + allowed[kind]) << c.name;
      EXPECT_LT(left, allowed[kind]) << c.name;
    }
  }
}

/// As accurate as the slab: the bounds are those of the slab's scene (test_scenes.cpp).
TEST(PlaneStrain, ScenesAsAccurateAsSlabs) {
  Solved solved{parse_scene(in_plane_strain(text_of("two_solids.toml"), "x"), file_of("two_solids.toml")), nullptr};
  run(solved);
  EXPECT_EQ(solved.results().unknowns, 912);
  ASSERT_FALSE(solved.results().pressure_errors.empty());
  EXPECT_EQ(solved.results().pressure_errors[0].zone, "whole");
  EXPECT_LT(solved.results().pressure_errors[0].sprc, 0.015);
}

const char* const two_blocks = R"(
[[body]]
name = "lower"
shape = {box = {min = [0, 0, 0], max = [0.1, 1, 0.6]}}
material = {E = 200e9, nu = 0.3}
cell_size = 0.13
grid = {offset = [0.1, 0.7, 0.3], rotation = {axis = [1, 0, 0], angle = 20}}

[[body]]
name = "upper"
shape = {box = {min = [0, 0, 0.6], max = [0.1, 1, 1.3]}}
material = {E = 70e9, nu = 0.2}
cell_size = 0.1
grid = {offset = [0, 0.2, 0.6]}

[[support]]
face = "lower.z-"
symmetry = true

[[support]]
face = "lower.y-"
symmetry = true

[[support]]
face = "upper.y-"
symmetry = true

[[load]]
face = "upper.z+"
pressure = 1e8

[[contact]]
faces = ["lower.z+", "upper.z-"]
)";

/// Uniform pressure: sigma_zz = -p, sigma_xx = -nu p, across grids turned about x.
TEST(PlaneStrain, PatchTest) {
  const double p = 1e8;
  Solved solved = read(std::string("plane_strain = \"x\"\n") + two_blocks, "blocks.toml",
                       {"solver.tolerance=1e-13", "solver.linear_tolerance=1e-15"});
  run(solved);
  const Results& r = solved.results();
  const double nu[2] = {0.3, 0.2}, height[2] = {0.6, 0.7};
  ASSERT_FALSE(r.contact_rows.empty());
  for (const ContactRow& row : r.contact_rows) {
    for (const double value : {row.pressure_raw, row.pressure_spr, row.pressure_sprc}) EXPECT_NEAR(value / p, 1, 1e-10);
    Sym3 exact = Sym3::Zero();
    exact[0] = -nu[row.body] * p;
    exact[2] = -p;
    for (const Sym3& s : {row.stress_raw, row.stress_spr, row.stress_sprc}) EXPECT_LT((s - exact).norm() / p, 1e-10);
  }
  EXPECT_NEAR(r.pairs[0].force_on_first[2] / (-0.1 * p), 1, 1e-10);
  EXPECT_LT(r.estimated_error_relative, 1e-10);
  // The ends push with nu p on their area.
  ASSERT_EQ(r.supports.size(), 7u);
  for (int b = 0; b < 2; ++b)
    for (int side = 0; side < 2; ++side) {
      const SupportFigures& end = r.supports[3 + 2 * b + side];
      EXPECT_EQ(end.condition, "plane strain");
      EXPECT_NEAR(end.force[0] / (nu[b] * p * height[b]), side == 0 ? 1 : -1, 1e-10) << end.face;
    }
  for (const BodyBalance& balance : r.balance)
    EXPECT_LT((balance.loads + balance.supports + balance.contact).norm(), 1e-9 * p);
}

/// The same with both bodies refined by hand, and for any thickness, here three times the smallest cells and a
/// twentieth of the largest: forces are those of the thickness, but for what holds the ends.
TEST(PlaneStrain, PatchTestOnQuadtrees) {
  const double p = 1e8, nu[2] = {0.3, 0.2}, height[2] = {0.6, 0.7};
  for (const double thickness : {0.05, 0.005}) {
    std::string text = std::string("plane_strain = \"x\"\n") + two_blocks;
    const auto replace = [&](const std::string& from, const std::string& to) {
      const std::size_t index = text.find(from);
      ASSERT_NE(index, std::string::npos) << from;
      text.replace(index, from.size(), to);
    };
    for (int b = 0; b < 2; ++b) replace("max = [0.1,", "max = [" + std::to_string(thickness) + ",");
    replace("cell_size = 0.13\n",
            "cell_size = 0.13\nrefine = [{sphere = {center = [0, 0.4, 0.6], radius = 0.1}, size = "
            "0.0162}]\n");
    replace("cell_size = 0.1\n",
            "cell_size = 0.1\nrefine = [{box = {min = [0, 0.6, 0.6], max = [1, 0.7, 0.7]}, size = "
            "0.025}, {face = \"z-\", size = 0.05}]\n");
    Solved solved = read(text, "blocks.toml", {"solver.tolerance=1e-13", "solver.linear_tolerance=1e-15"});
    run(solved);
    const Results& r = solved.results();
    const SolvedState& state = solved.simulation->state;
    EXPECT_EQ(state.bodies[0].cut_cells.num_levels(), 5);
    EXPECT_EQ(state.bodies[1].cut_cells.num_levels(), 3);
    ASSERT_FALSE(r.contact_rows.empty());
    double area = 0;
    for (const ContactRow& row : r.contact_rows) {
      area += row.weight;
      for (const double value : {row.pressure_raw, row.pressure_spr, row.pressure_sprc})
        EXPECT_NEAR(value / p, 1, 1e-9);
      Sym3 exact = Sym3::Zero();
      exact[0] = -nu[row.body] * p;
      exact[2] = -p;
      for (const Sym3& s : {row.stress_raw, row.stress_spr, row.stress_sprc}) EXPECT_LT((s - exact).norm() / p, 1e-9);
    }
    EXPECT_NEAR(area / (2 * thickness), 1, 1e-9);
    EXPECT_NEAR(r.pairs[0].force_on_first[2] / (-thickness * p), 1, 1e-9);
    EXPECT_LT(r.estimated_error_relative, 1e-9);
    ASSERT_EQ(r.supports.size(), 7u);
    for (int b = 0; b < 2; ++b)
      for (int side = 0; side < 2; ++side) {
        const SupportFigures& end = r.supports[3 + 2 * b + side];
        EXPECT_NEAR(end.force[0] / (nu[b] * p * height[b]), side == 0 ? 1 : -1, 1e-9) << end.face;
        EXPECT_NEAR(end.area, height[b], 1e-9) << end.face;
      }
    for (const BodyBalance& balance : r.balance)
      EXPECT_LT((balance.loads + balance.supports + balance.contact).norm(), 1e-9 * p * thickness);
    const auto u = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), state.outer.u);
    for (const BodyMesh& mesh : state.system.meshes)
      for (const auto& nodes : mesh.cell_nodes)
        for (int a = 0; a < 8; a += 2)
          for (int i = 0; i < 3; ++i) EXPECT_EQ(u(dof_of(nodes[a], i)), u(dof_of(nodes[a + 1], i)));
  }
}

/// Three points for each component of a body have the area, the centre and the second moments of the component's end,
/// here of rectangles that fill their cells: as rigid bodies both are held as by all of their ends.
TEST(PlaneStrain, ThreePointsHoldAComponent) {
  const Scene scene = parse_scene(R"(
plane_strain = "x"
[[body]]
name = "two"
shape = {union = [{name = "a", box = {min = [0, 5, 3], max = [0.1, 5.4, 3.2]}},
                  {name = "b", box = {min = [0, 5.6, 3], max = [0.1, 5.8, 3.6]}}]}
material = {E = 1, nu = 0.3}
cell_size = 0.1
[[body]]
name = "below"
shape = {name = "box", box = {min = [0, 5, 2.5], max = [0.1, 5.4, 3]}}
material = {E = 1, nu = 0.3}
cell_size = 0.1
[[support]]
face = "below.box.z-"
displacement = {y = 0, z = 0}
[[support]]
face = "two.b.y+"
displacement = {y = 0, z = 0}
[[contact]]
faces = ["two.a.z-", "below.box.z+"]
bonded = true
)",
                                  "scene.toml");
  struct Rectangle {
    double width, height;
    Vec3 centre;
  };
  for (const auto& [width, height, centre] : {Rectangle{0.4, 0.2, {0.05, 5.2, 3.1}}, {0.2, 0.6, {0.05, 5.7, 3.3}}}) {
    double area = 0;
    Vec3 first = Vec3::Zero();
    Mat3 second = Mat3::Zero();
    int count = 0;
    const Preparation preparation = prepare(scene);
    for (const SupportPoint& point : preparation.supports) {
      if (!point.implied || point.body != 0) continue;
      const Vec3 x = global_position(preparation.bodies[0].cut_cells, point.cell, point.xi) - centre;
      if (std::abs(x[1]) > width) continue;
      ++count;
      area += point.weight;
      first += point.weight * x;
      second += point.weight * x * x.transpose();
    }
    EXPECT_EQ(count, 3);
    EXPECT_NEAR(area / (width * height), 1, 1e-12);
    EXPECT_LT(first.tail<2>().norm(), 1e-12 * area);
    EXPECT_NEAR(second(1, 1) / area, width * width / 12, 1e-12);
    EXPECT_NEAR(second(2, 2) / area, height * height / 12, 1e-12);
    EXPECT_NEAR(second(1, 2) / area, 0, 1e-12);
  }
}

/// The message of what `cgcontact check` says to the scene with some text replaced, or "".
std::string refusal(const std::vector<std::pair<std::string, std::string>>& changes) {
  std::string text = std::string("plane_strain = \"x\"\n") + two_blocks;
  for (const auto& [from, to] : changes) {
    const std::size_t index = text.find(from);
    EXPECT_NE(index, std::string::npos) << from;
    text.replace(index, from.size(), to);
  }
  try {
    prepare(parse_scene(text, "scene.toml"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PlaneStrain, WhatContradictsItIsRefused) {
  struct Case {
    std::vector<std::pair<std::string, std::string>> changes;
    std::vector<std::string> expected;
  };
  const std::string last = "faces = [\"lower.z+\", \"upper.z-\"]\n";
  const std::vector<Case> cases{
      {{{"max = [0.1, 1, 0.6]", "max = [0.14, 1, 0.6]"}},
       {"scene.toml:1: plane_strain = \"x\"", "\"lower\"", "0.14 m thick", "0.065 to 0.117 m"}},
      {{{"max = [0.1, 1, 0.6]", "max = [0.02, 1, 0.6]"}}, {"0.02 m thick", "fill half of it"}},
      {{{"shape = {box = {min = [0, 0, 0], max = [0.1, 1, 0.6]}}",
         "shape = {difference = [{box = {min = [0, 0, 0], max = [0.1, 1, 0.6]}}, {name = \"hole\", sphere = {center = "
         "[0.05, 0.5, 0.3], radius = 0.04}}]}"}},
       {"scene.toml:1", "neither an end nor along the axis", "prism"}},
      {{{"shape = {box = {min = [0, 0, 0], max = [0.1, 1, 0.6]}}",
         "shape = {difference = [{box = {min = [0, 0, 0], max = [0.1, 1, 0.6]}}, {name = \"cut\", cylinder = {base = "
         "[0.05, 0.5, 0.3], top = [1, 0.5, 0.3], radius = 0.1}}]}"}},
       {"neither an end nor along the axis", "at (0.05"}},
      {{{last, last + "[[support]]\nface = \"upper.x-\"\nsymmetry = true\n"}},
       {"scene.toml:", "\"upper.x-\"", "lies on an end", "sides only"}},
      {{{"face = \"lower.z-\"\nsymmetry = true", "face = \"lower.z-\"\ndisplacement = {z = 0, x = 1e-6}"}},
       {"\"lower.z-\"", "along x", "or 0"}},
      {{{"face = \"upper.z+\"", "face = \"upper.x+\""}}, {"\"upper.x+\"", "lies on an end", "loads on the sides"}},
      {{{"pressure = 1e8", "pressure = 1e8\ntraction = [1e7, 0, 0]"}}, {"\"upper.z+\"", "acts along x"}},
      {{{"cell_size = 0.1\n", "cell_size = 0.1\nbody_force = [1, 0, -1]\n"}}, {"force on its volume acts along"}},
  };
  for (const Case& c : cases) {
    const std::string message = refusal(c.changes);
    for (const std::string& text : c.expected)
      EXPECT_NE(message.find(text), std::string::npos) << text << "\n" << message;
  }
  EXPECT_EQ(refusal({}), "");
  // Held along x as well: that is true anyway.
  EXPECT_EQ(refusal({{"face = \"lower.z-\"\nsymmetry = true", "face = \"lower.z-\"\ndisplacement = {z = 0, x = 0}"}}),
            "");
}

/// What is new beside refined cells: all bodies between the same two planes, and prisms.
TEST(PlaneStrain, WhatContradictsAQuadtreeIsRefused) {
  const std::string coarse = "cell_size = 0.13\n", refined = coarse + "refine = [{face = \"z+\", size = 0.02}]\n";
  const std::string lower = "shape = {box = {min = [0, 0, 0], max = [0.1, 1, 0.6]}}";
  const auto expect = [&](const std::string& from, const std::string& to, const std::vector<std::string>& expected) {
    const std::string message = refusal({{coarse, refined}, {from, to}});
    for (const std::string& text : expected)
      EXPECT_NE(message.find(text), std::string::npos) << text << "\n" << message;
  };
  expect("max = [0.1, 1, 0.6]", "max = [0.14, 1, 0.6]",
         {"scene.toml:1: plane_strain = \"x\"", "\"upper\"", "between 0 and 0.1 m", "\"lower\" between 0 and 0.14 m",
          "the same ends"});
  expect(lower,
         "shape = {difference = [{box = {min = [0, 0, 0], max = [0.1, 1, 0.6]}}, {name = \"hole\", sphere = {center = "
         "[0.05, 0.5, 0.3], radius = 0.04}}]}",
         {"scene.toml:1: plane_strain = \"x\"", "\"lower\"", "\"hole.surface\"",
          "neither an end of a prism nor along its axis", "between two planes"});
  expect(lower,
         "shape = {difference = [{box = {min = [0, 0, 0], max = [0.1, 1, 0.6]}}, {name = \"cut\", cylinder = {base = "
         "[0.05, 0.5, 0.3], top = [1, 0.5, 0.3], radius = 0.1}}]}",
         {"\"cut.bottom\"", "neither an end of a prism"});
  EXPECT_EQ(refusal({{coarse, refined}}), "");
}

/// Motions in the plane are free as ever.
TEST(PlaneStrain, FreeMotionsAreFound) {
  const std::string message = refusal({{"[[support]]\nface = \"upper.y-\"\nsymmetry = true\n", ""}});
  EXPECT_NE(message.find("body \"upper\" is free to move"), std::string::npos) << message;
}

}  // namespace
}  // namespace cgcontact::test_plane_strain
