/// Bodies of revolution: cells of a half-plane through the axis, strain u_r / r around it, volume in proportion to r.
#include <gtest/gtest.h>

#include "kernels/solver/linear_solver.hpp"
#include "tests/support/constrained_system.hpp"

namespace cgcontact::test_axisymmetric {
namespace {

using namespace test;

constexpr double unit_radius = 0.8;

/// Quarter of a disc between the radii `bore` and `rim`: a half ball, or a ring of that section. Refined towards its
/// upper end, down to an eighth of the cells 1/n.
CutCells quadtree(int across, double rim, double bore, int n = 6, int divisions = 8) {
  const int radial = (across + 2) % 3, along = (across + 1) % 3;
  const double h = 1.0 / n;
  Grid grid;
  grid.cell_size = h;
  grid.plane_strain = across;
  grid.num_cells = {n + 3, n + 3, n + 3};
  grid.num_cells[across] = 1;
  grid.num_cells[radial] = static_cast<int>(std::ceil(rim * n)) + 2;
  grid.origin[along] = -h * (std::sqrt(3.0) - 1.5);
  grid.origin[across] = -0.5 * h;
  grid.slice = h / divisions;
  grid.unit_radius = unit_radius;
  grid.thickness = 2 * pi * unit_radius;
  Vec3 low = Vec3::Zero(), high = Vec3::Constant(2 * rim), base = Vec3::Zero(), top = Vec3::Zero();
  low[across] = base[across] = -3 * h;  // beyond the layer
  high[across] = top[across] = 3 * h;
  low[radial] = base[radial] = top[radial] = bore;
  const Solid solid = Solid::intersect(Solid::box(low, high, "box"), Solid::cylinder(base, top, rim - bore, "rim"));
  return cut_refined(solid, grid, (rim - bore) * Vec3::Unit(along) + bore * Vec3::Unit(radial), 1.0 / divisions, 0.3,
                     divisions);
}

struct Body {
  const char* name;
  CutCells cells;
};

std::vector<Body> bodies() {
  return {{"about z, with its axis", quadtree(1, 0.9, 0)},
          {"about x, with its axis", quadtree(2, 0.9, 0)},
          {"about y, with a hole", quadtree(0, 0.9, 0.37)},
          {"one level", quadtree(1, 0.9, 0, 11, 1)}};
}

/// Supports along odd directions of the half-plane on some of the boundary.
void add_supports(ElasticSystem& system, const CutCells& cells) {
  std::vector<SupportTerm> terms;
  for (std::size_t p = 0; p < cells.boundary.size(); p += 3) {
    const int cell = cells.boundary.cell[p];
    Vec3 direction(0.6, 0.6, 0.6);
    direction[cells.grid.plane_strain] = 0;
    direction[cells.grid.radial_axis()] *= p % 2 ? 1 : -0.5;
    terms.push_back({cell, cell_coordinates(cells, cell, cells.boundary.position[p]), direction.normalized(),
                     0.7 * cells.boundary.weight[p]});
  }
  add_support_terms(system, 0, terms);
}

/// u_r = a r, u_along = b z.
RealView linear_state(const ElasticSystem& system, double a, double b) {
  const BodyMesh& mesh = system.meshes[0];
  const Grid& grid = mesh.cut_cells->grid;
  RealView u("u", system.num_dofs());
  for (int n = 0; n < mesh.num_nodes; ++n) {
    const Vec3 x = grid.to_global(mesh.node_position(n));
    u(dof_of(n, grid.radial_axis())) = a * x[grid.radial_axis()];
    u(dof_of(n, grid.axis_of_revolution())) = b * x[grid.axis_of_revolution()];
  }
  return u;
}

TEST(Axisymmetric, ProductsAgree) {
  for (const Body& body : bodies()) {
    ElasticSystem system = make_system(body.cells);
    add_supports(system, body.cells);
    SCOPED_TRACE(body.name);
    expect_same_products(system, 1000);
  }
}

TEST(Axisymmetric, OnTheAxisNothingMovesAwayFromIt) {
  const CutCells cells = quadtree(1, 0.9, 0);
  const ElasticSystem system = make_system(cells);
  const RealView x = consistent(system, random_vector(system.num_dofs(), 4));
  int on_axis = 0;
  for (int n = 0; n < system.num_nodes; ++n) {
    const Vec3 position = cells.grid.to_global(system.meshes[0].node_position(n));
    EXPECT_EQ(x(dof_of(n, 1)), 0);
    if (std::abs(position[0]) > 1e-12) continue;
    ++on_axis;
    EXPECT_EQ(x(dof_of(n, 0)), 0);
  }
  EXPECT_GT(on_axis, 10);
}

/// The volume of a half ball, and the area of its round side, both for a slice: nothing else is integrated.
TEST(Axisymmetric, VolumeAndAreaAreThoseOfTheBody) {
  for (const int across : {0, 1, 2}) {
    const CutCells cells = quadtree(across, 0.9, 0);
    const double h = cells.grid.cell_size;
    double volume = 0, area = 0;
    for (int e = 0; e < static_cast<int>(cells.cells.size()); ++e) volume += cells.volume(e);
    for (std::size_t p = 0; p < cells.boundary.size(); ++p) {
      const Vec3 x = cells.grid.to_global(cells.boundary.position[p]) - cells.grid.middle * Vec3::Unit(across);
      if (std::abs(x.norm() - 0.9) < 1e-6) area += cells.boundary.weight[p];
    }
    EXPECT_NEAR(volume * h * h * h * cells.grid.slices(), 2. / 3 * pi * std::pow(0.9, 3), 1e-8);
    CutCells without = cells;
    without.drop_moments();
    for (int e = 0; e < static_cast<int>(cells.cells.size()); ++e) EXPECT_EQ(without.volume(e), cells.volume(e)) << e;
    EXPECT_NEAR(area * h * h * cells.grid.slices(), 2 * pi * 0.9 * 0.9, 1e-6);
  }
}

/// A shift along the axis has no forces. Uniform strain has none inside, and the energy of its stress.
TEST(Axisymmetric, UniformStatesAreExact) {
  for (const Body& body : bodies()) {
    const ElasticSystem system = make_system(body.cells);
    const BodyMesh& mesh = system.meshes[0];
    const Grid& grid = body.cells.grid;
    RealView shift("shift", system.num_dofs());
    for (int n = 0; n < mesh.num_nodes; ++n) shift(dof_of(n, grid.axis_of_revolution())) = 1;
    const double scale = norm(apply(system, consistent(system, random_vector(system.num_dofs(), 1))));
    EXPECT_LT(norm(apply(system, shift)), 1e-12 * scale) << body.name;
    const double a = 0.3, b = -0.7;
    const RealView u = linear_state(system, a, b), f = apply(system, u);
    EXPECT_LT(norm(difference(u, consistent(system, u))), 1e-14 * norm(u)) << body.name;
    double volume = 0;
    for (int e = 0; e < static_cast<int>(body.cells.cells.size()); ++e) volume += body.cells.volume(e);
    volume *= std::pow(grid.cell_size, 3);
    const double trace = 2 * a + b, squares = 2 * a * a + b * b;
    EXPECT_NEAR(dot(u, f) / (mesh.modulus * volume * (mesh.law.lambda * trace * trace + 2 * mesh.law.mu * squares)), 1,
                1e-12)
        << body.name;
    std::vector<char> at_boundary(system.num_nodes, 0);
    for (const int cell : body.cells.boundary.cell)
      for (const int n : mesh.cell_nodes[cell]) {
        at_boundary[n] = 1;
        if (!mesh.is_free(n))
          for (const auto& [master, weight] : mesh.constraints[mesh.constraint_of_node[n]].masters)
            at_boundary[master] = 1;
      }
    double inside = 0;
    for (int n = 0; n < system.num_nodes; ++n)
      for (int i = 0; i < 3 && !at_boundary[n]; ++i) inside = std::max(inside, std::abs(f(dof_of(n, i))));
    EXPECT_LT(inside, 1e-13) << body.name;
  }
}

/// Down to slivers of 1e-9 of a cell, beside the axis and far from it.
TEST(Axisymmetric, FewIterations) {
  for (const double bore : {0.0, 4. / 12, 20.0})
    for (const double sliver : {0.4, 1e-3, 1e-6, 1e-9}) {
      const int n = 12;
      const CutCells cells = quadtree(1, bore + (n - 2 + sliver) / n, bore == 0 ? 0 : bore - sliver / n, n);
      ElasticSystem system = make_system(cells, 0.02);
      add_supports(system, cells);
      LinearSolver solver(ExecSpace(), system, Preconditioner::multigrid);
      solver.update();
      const RealView b = random_force(system, 6), x("x", system.num_dofs());
      const LinearSolveResult result = solver.solve(b, x, 1e-10 * norm(b), 200);
      std::printf("bore %g, sliver %g: %d unknowns, %d iterations\n", bore, sliver, system.num_free_dofs(),
                  result.iterations);
      EXPECT_TRUE(result.converged);
      EXPECT_LE(result.iterations, 20);
    }
}

}  // namespace
}  // namespace cgcontact::test_axisymmetric
