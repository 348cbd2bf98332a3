/// CG with multigrid, all contact closed: how many iterations to 1e-8 of a random right-hand side, over refinements,
/// slivers, positions of the grids, stiffness ratios and scenes. Every case prints a line of the table.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "contact/simulation.hpp"
#include "core/scene_file/read_scene.hpp"
#include "kernels/solver/linear_solver.hpp"

namespace cgcontact::test_solver_robustness {
namespace {

constexpr int max_iterations = 9;  // solid bodies, and those held across their thickness
constexpr int max_when_thin = 15;  // what bends

Scene scene_of(const std::string& name, int n) {
  return read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/scenes/" + name + ".toml", {"n=" + std::to_string(n)});
}

/// Solves; `what` names the line of the table. 1000: not converged.
int iterations(const Scene& scene, const std::string& what, double tolerance = 1e-8) {
  Simulation sim(scene);
  sim.set_up_grids();
  sim.make_system();
  set_group_stiffness(sim.state.system, sim.state.system.full_group_stiffness);
  LinearSolver solver(ExecSpace(), sim.state.system, Preconditioner::multigrid);
  solver.update();
  const int size = sim.state.system.num_dofs();
  const RealView b("b", size), x("x", size);
  std::mt19937 random(1);
  double sum = 0;
  for (int i = 0; i < size; ++i) {
    b(i) = std::uniform_real_distribution<double>(-1, 1)(random);
    sum += b(i) * b(i);
  }
  const LinearSolveResult result = solver.solve(b, x, tolerance * std::sqrt(sum), 200);
  std::printf("%-44s %8d unknowns %4d iterations\n", what.c_str(), size, result.iterations);
  return result.converged ? result.iterations : 1000;
}

void expect_flat(const std::string& scene, const std::vector<int>& refinements) {
  std::vector<int> counts;
  for (int n : refinements) {
    counts.push_back(iterations(scene_of(scene, n), scene + ", n = " + std::to_string(n)));
    EXPECT_LE(counts.back(), max_iterations) << n;
  }
  for (int count : counts) EXPECT_LE(std::abs(count - counts[counts.size() / 2]), 2);
}

/// MueLu instead of multigrid, in a solver that is already set up: the same solution, once. The outer iteration
/// does this where multigrid throws.
TEST(SolverRobustness, FallBack) {
  const Scene scene = scene_of("two_solids_3d", 8);
  Simulation sim(scene);
  sim.set_up_grids();
  sim.make_system();
  set_group_stiffness(sim.state.system, sim.state.system.full_group_stiffness);
  LinearSolver solver(ExecSpace(), sim.state.system, Preconditioner::multigrid);
  const int size = sim.state.system.num_dofs();
  const RealView b("b", size), first("first", size), second("second", size);
  double sum = 0;
  for (int i = 0; i < size; ++i) sum += std::pow(b(i) = std::sin(i), 2);
  solver.update();
  EXPECT_TRUE(solver.solve(b, first, 1e-12 * std::sqrt(sum), 200).converged);
  EXPECT_TRUE(solver.fall_back());
  EXPECT_TRUE(solver.needs_supports());
  solver.update();
  EXPECT_TRUE(solver.solve(b, second, 1e-12 * std::sqrt(sum), 400).converged);
  EXPECT_FALSE(solver.fall_back());
  double largest = 0, difference = 0;
  for (int i = 0; i < size; ++i) {
    largest = std::max(largest, std::abs(first(i)));
    difference = std::max(difference, std::abs(second(i) - first(i)));
  }
  EXPECT_LT(difference, 1e-7 * largest);  // residuals of 1e-12 times a condition of some 1e4, with room
}

TEST(SolverRobustness, RefinementsOfTwoSolids) { expect_flat("two_solids_3d", {8, 12, 18}); }
TEST(SolverRobustness, RefinementsOfRings) { expect_flat("rings", {12, 24, 48}); }
TEST(SolverRobustness, RefinementsOfHertz) { expect_flat("hertz", {8, 12, 18}); }

/// Both grids leave slivers of the given width on the contact face, and on two other faces of each body.
TEST(SolverRobustness, Slivers) {
  for (int digits = 1; digits <= 12; ++digits) {
    Scene scene = scene_of("two_solids_3d", 10);
    const double width = std::pow(10.0, -digits);
    scene.bodies[0].grid_offset = Vec3::Constant(width);
    scene.bodies[1].grid_offset = Vec3::Constant(1 - width);
    EXPECT_LE(iterations(scene, "slivers of 1e-" + std::to_string(digits)), max_iterations);
  }
}

TEST(SolverRobustness, ShiftsAndRotations) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(0, 1), angle(-1, 1);
  for (int i = 0; i < 20; ++i) {
    Scene scene = scene_of("two_solids_3d", 8);
    for (BodySpec& body : scene.bodies) {
      for (int d = 0; d < 3; ++d) body.grid_offset[d] = shift(random);
      const Vec3 axis = Vec3(angle(random), angle(random), angle(random)).normalized();
      body.grid_rotation = Eigen::AngleAxisd(pi * angle(random), axis).toRotationMatrix();
    }
    EXPECT_LE(iterations(scene, "shift and rotation " + std::to_string(i + 1)), max_iterations);
  }
}

TEST(SolverRobustness, StiffnessRatios) {
  for (int exponent = -3; exponent <= 3; ++exponent) {
    Scene scene = scene_of("two_solids_3d", 10);
    scene.bodies[1].material.youngs_modulus *= std::pow(10.0, exponent);
    EXPECT_LE(iterations(scene, "upper body stiffer by 1e" + std::to_string(exponent)), max_iterations);
  }
}

/// Plane strain: one cell thick.
TEST(SolverRobustness, RefinementsOfPlaneStrain) {
  for (int n : {16, 32, 64, 128})
    EXPECT_LE(iterations(scene_of("two_solids", n), "plane strain, n = " + std::to_string(n)), max_iterations) << n;
}

TEST(SolverRobustness, PlaneStrainOfSeveralCells) {
  for (int layers = 1; layers <= 3; ++layers)
    for (int digits : {1, 4, 8}) {
      Scene scene = read_scene(std::string(CGCONTACT_SOURCE_DIR) + "/scenes/two_solids.toml",
                               {"n=24", "t=" + std::to_string(layers) + "*0.01/24"});
      const double width = std::pow(10.0, -digits);
      for (BodySpec& body : scene.bodies)
        body.grid_offset = Vec3::Constant(&body == &scene.bodies[0] ? width : 1 - width);
      EXPECT_LE(iterations(scene, std::to_string(layers) + " cells, slivers of 1e-" + std::to_string(digits)),
                max_iterations);
    }
}

TEST(SolverRobustness, StiffnessRatiosInPlaneStrain) {
  for (int exponent = -3; exponent <= 3; ++exponent) {
    Scene scene = scene_of("two_solids", 24);
    scene.bodies[1].material.youngs_modulus *= std::pow(10.0, exponent);
    EXPECT_LE(iterations(scene, "plane strain, upper body stiffer by 1e" + std::to_string(exponent)), max_iterations);
  }
}

/// A plate of cells of size 1, held at one end face, in a grid that is turned about an axis.
Scene cantilever(const Index3& cells, const Vec3& offset, const std::string& axis = "[0, 0, 1]", double angle = 0) {
  const auto text = [](double x) { return fmt::format("{}", x); };
  return parse_scene(
      "[[body]]\nname = \"plate\"\nmaterial = {E = 1, nu = 0.3}\ncell_size = 1\n"
      "shape = {name = \"block\", box = {min = [0, 0, 0], max = [" +
          text(cells[0]) + ", " + text(cells[1]) + ", " + text(cells[2]) + "]}}\n" + "grid = {offset = [" +
          text(offset[0]) + ", " + text(offset[1]) + ", " + text(offset[2]) + "], rotation = {axis = " + axis +
          ", angle = " + text(angle) + "}}\n" +
          "[[support]]\nface = \"plate.block.x-\"\ndisplacement = {x = 0, y = 0, z = 0}\n",
      "cantilever.toml");
}

/// Plates that bend, with free edges that do not fit the grid: one, two and three cells thick.
TEST(SolverRobustness, FreePlates) {
  for (const Index3& cells : {Index3{20, 10, 1}, Index3{40, 20, 1}, Index3{40, 20, 2}, Index3{80, 40, 1},
                              Index3{80, 40, 2}, Index3{80, 40, 3}, Index3{160, 80, 1}, Index3{200, 4, 1}})
    EXPECT_LE(iterations(cantilever(cells, {0.3, 0.21, 0.15}),
                         fmt::format("plate of {} x {} x {} cells", cells[0], cells[1], cells[2])),
              max_when_thin);
  EXPECT_LE(iterations(cantilever({80, 40, 1}, {0.3, 0.21, 0.15}, "[0, 0, 1]", 20), "80 x 40, turned in its plane"),
            max_when_thin);
  for (int digits : {1, 4, 8}) {
    const double width = std::pow(10.0, -digits);
    for (const Vec3& offset : {Vec3(Vec3::Constant(width)), Vec3(Vec3::Constant(1 - width))})
      EXPECT_LE(iterations(cantilever({40, 20, 1}, offset), "plate with slivers of 1e-" + std::to_string(digits)),
                max_when_thin);
  }
}

/// The same across the grid.
TEST(SolverRobustness, PlatesAcrossTheGrid) {
  const std::pair<const char*, double> turns[] = {{"[0, 1, 0]", 20}, {"[0, 1, 0]", 45}, {"[1, 2, 3]", 20}};
  for (const auto& [axis, angle] : turns)
    for (int thickness = 1; thickness <= 3; ++thickness)
      EXPECT_LE(iterations(cantilever({80, 40, thickness}, {0.3, 0.21, 0.15}, axis, angle),
                           fmt::format("80 x 40 x {}, by {} degrees about {}", thickness, angle, axis)),
                max_when_thin);
  EXPECT_LE(iterations(cantilever({160, 80, 1}, {0.3, 0.21, 0.15}, "[0, 1, 0]", 20), "160 x 80 x 1, by 20 degrees"),
            17);
}

/// A quarter of a cylinder's wall, cells of size 1, held at one straight edge.
TEST(SolverRobustness, BentSheets) {
  for (const auto& [radius, thickness] : {std::pair{40, 1}, std::pair{40, 2}, std::pair{40, 3}, std::pair{80, 1}}) {
    const Scene scene = parse_scene(
        fmt::format("[[body]]\nname = \"sheet\"\nmaterial = {{E = 1, nu = 0.3}}\ncell_size = 1\n"
                    "grid = {{offset = [0.3, 0.21, 0.15]}}\n"
                    "shape = {{difference = [{{intersection = [\n"
                    "  {{name = \"quarter\", box = {{min = [0, 0, 0], max = [{1}, {1}, {0}]}}}},\n"
                    "  {{name = \"rim\", cylinder = {{base = [0, 0, -1], top = [0, 0, {1}], radius = {2}}}}}]}},\n"
                    "  {{name = \"bore\", cylinder = {{base = [0, 0, -1], top = [0, 0, {1}], radius = {0}}}}}]}}\n"
                    "[[support]]\nface = \"sheet.quarter.x-\"\ndisplacement = {{x = 0, y = 0, z = 0}}\n",
                    radius, radius + 2 * thickness, radius + thickness),
        "sheet.toml");
    EXPECT_LE(iterations(scene, fmt::format("sheet of radius {}, {} cells thick", radius, thickness)), max_when_thin);
  }
}

/// A strip in plane strain that bends. The condition number of a cantilever is (length / thickness)^4, 1e12 for 1000
/// cells: rounding of x in A x leaves a residual of some 1e-8 there, whatever solves.
TEST(SolverRobustness, LongStrips) {
  for (const auto& [cells, tolerance] : {std::pair{200, 1e-8}, std::pair{400, 1e-8}, std::pair{1000, 1e-7}}) {
    const Scene scene =
        parse_scene(fmt::format("[[body]]\nname = \"strip\"\nmaterial = {{E = 1, nu = 0.3}}\ncell_size = 1\n"
                                "shape = {{name = \"block\", box = {{min = [0, 0, 0], max = [{}, 1, 1]}}}}\n"
                                "grid = {{offset = [0.3, 0.21, 0.15]}}\n"
                                "[[support]]\nface = \"strip.block.x-\"\ndisplacement = {{x = 0, y = 0, z = 0}}\n"
                                "[[support]]\nface = \"strip.block.y-\"\nsymmetry = true\n"
                                "[[support]]\nface = \"strip.block.y+\"\nsymmetry = true\n",
                                cells),
                    "strip.toml");
    EXPECT_LE(iterations(scene, fmt::format("strip of {} cells", cells), tolerance), max_when_thin);
  }
}

}  // namespace
}  // namespace cgcontact::test_solver_robustness
