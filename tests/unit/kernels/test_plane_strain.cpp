/// Bodies in plane strain: the system of the shared unknowns is that of the slab, restricted to displacements that do
/// not vary across it.
#include <gtest/gtest.h>

#include "kernels/multigrid/coarsen.hpp"
#include "kernels/solver/linear_solver.hpp"
#include "tests/support/constrained_system.hpp"

namespace cgcontact::test_plane_strain {
namespace {

using namespace test;

constexpr double eps = 2.2e-16;

struct Body {
  const char* name;
  CutCells cells;
};

/// A prism between the planes 0 and `thickness` (cells) of an axis: sector of a ring, cut everywhere by round sides.
CutCells ring(int axis, double thickness, int n) {
  const double h = 1.0 / n, t = thickness * h;
  Vec3 low = Vec3::Zero(), high = Vec3::Ones(), base = Vec3::Zero(), top = Vec3::Zero();
  high[axis] = t;
  base[axis] = -1;
  top[axis] = 1;
  const Solid quarter = Solid::intersect(Solid::box(low, high, "box"), Solid::cylinder(base, top, 0.9, "rim"));
  const Solid solid = Solid::subtract(quarter, Solid::cylinder(base, top, 0.45, "bore"));
  Grid grid;
  grid.cell_size = h;
  grid.plane_strain = axis;
  grid.num_cells = {n + 2, n + 2, n + 2};
  grid.num_cells[axis] = 1;
  grid.origin = -h * Vec3(std::sqrt(2.0) - 1.2, std::sqrt(3.0) - 1.5, std::sqrt(5.0) - 2.1);
  grid.origin[axis] = thickness < 1 ? -0.1 * h : 0;
  return cut(solid, grid);
}

std::vector<Body> bodies() {
  return {{"across x", ring(0, 1, 9)},
          {"across y, thin", ring(1, 0.77, 9)},
          {"across z", ring(2, 1, 9)},
          {"across x, thin", ring(0, 0.77, 9)}};
}

CutCells slab(const CutCells& cells) {
  CutCells same = cells;
  same.grid.plane_strain = -1;
  return same;
}

/// Supports along two odd directions in the plane on some of the boundary.
void add_supports(ElasticSystem& system, const CutCells& cells) {
  const int axis = system.meshes[0].cut_cells->grid.plane_strain;
  std::vector<SupportTerm> terms;
  for (std::size_t p = 0; p < cells.boundary.size(); p += 3) {
    const int cell = cells.boundary.cell[p];
    Vec3 direction(0.6, 0.6, 0.6);
    direction[axis < 0 ? 0 : axis] = 0;
    direction[(axis + 1) % 3] *= p % 2 ? 1 : -0.5;
    terms.push_back({cell, cell_coordinates(cells, cell, cells.boundary.position[p]), direction.normalized(), 0.7});
  }
  add_support_terms(system, 0, terms);
}

TEST(PlaneStrain, AThirdOfTheUnknowns) {
  for (const Body& body : bodies()) {
    const ElasticSystem system = make_system(body.cells);
    EXPECT_EQ(system.num_free_dofs(), system.num_dofs() / 3) << body.name;
    const RealView x = consistent(system, random_vector(system.num_dofs(), 1));
    const int axis = body.cells.grid.plane_strain;
    const BodyMesh& mesh = system.meshes[0];
    for (int n = 0; n < mesh.num_nodes; ++n) {
      EXPECT_EQ(x(dof_of(n, axis)), 0);
      Index3 opposite = mesh.nodes[n];
      opposite[axis] = 1 - opposite[axis];
      for (int i = 0; i < 3; ++i) EXPECT_EQ(x(dof_of(n, i)), x(dof_of(mesh.find_node(opposite), i)));
    }
  }
}

/// P^T A P of the slab, by the fast operator, its plain reference and the matrix.
TEST(PlaneStrain, SystemIsTheSlabRestricted) {
  for (const Body& body : bodies()) {
    ElasticSystem system = make_system(body.cells);
    add_supports(system, body.cells);
    const CutCells slab_cells = slab(body.cells);
    ElasticSystem whole = make_system(slab_cells);
    whole.supports = system.supports;
    const RealView x = consistent(system, random_vector(system.num_dofs(), 4)), y = apply(system, x);
    const RealView restricted = apply(whole, x);
    apply_constraints_transposed(ExecSpace(), system.dofs, restricted);
    EXPECT_LT(norm(difference(y, restricted)), 100 * eps * norm(restricted)) << body.name;
    SCOPED_TRACE(body.name);
    expect_same_products(system, 100);
  }
}

/// The smoother's node blocks are those of the shared unknowns, nothing left out.
TEST(PlaneStrain, NodeBlocksAreExact) {
  for (const Body& body : bodies()) {
    ElasticSystem system = make_system(body.cells);
    add_supports(system, body.cells);
    const FastOperator<double> op(system);
    const FastOperator<double>::BlockView blocks("blocks", system.num_nodes);
    op.diagonal_blocks(ExecSpace(), blocks);
    const int axis = body.cells.grid.plane_strain;
    constexpr int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    for (int n = 0; n < system.num_nodes; n += 7) {
      if (!system.meshes[0].is_free(n)) continue;
      for (int i = 0; i < 3; ++i) {
        if (i == axis) continue;
        RealView unit("unit", system.num_dofs());
        unit(dof_of(n, i)) = 1;
        const RealView column = apply(system, consistent(system, unit));
        for (int j = 0; j < 3; ++j) {
          if (j == axis) continue;
          EXPECT_NEAR(blocks(n, at[j][i]), column(dof_of(n, j)), 1e-13 * norm(column)) << body.name;
        }
      }
    }
  }
}

TEST(PlaneStrain, CoarseningIsTheGalerkinProduct) {
  for (const Body& body : bodies()) {
    CutCells fine_cells = body.cells;
    for (int level = 0; level < 2; ++level) {
      CutCells coarse_cells = coarse_cut_cells(fine_cells);
      const ElasticSystem fine = make_system(fine_cells, 0), coarse = make_system(coarse_cells, 0);
      EXPECT_EQ(coarse.num_free_dofs(), coarse.num_dofs() / 3);
      const Transfer transfer = make_transfer(fine, coarse);
      const RealView x = consistent(coarse, random_vector(coarse.num_dofs(), 3)), f = random_force(fine, 5);
      RealView Px("Px", fine.num_dofs()), Rf("Rf", coarse.num_dofs()), galerkin("galerkin", coarse.num_dofs());
      prolongate_add(ExecSpace(), transfer, fine.dofs, x, Px);
      restrict_to(ExecSpace(), transfer, coarse.dofs, f, Rf);
      EXPECT_NEAR(dot(Px, f), dot(x, Rf), 1e-13 * norm(Px) * norm(f)) << body.name << ": adjoint";
      restrict_to(ExecSpace(), transfer, coarse.dofs, apply(fine, Px), galerkin);
      const RealView Ax = apply(coarse, x);
      EXPECT_LT(norm(difference(galerkin, Ax)), 1e-12 * norm(Ax)) << body.name;
      fine_cells = std::move(coarse_cells);
    }
  }
}

/// Multigrid and MueLu; measured: 7 to 10 and 27 to 35.
TEST(PlaneStrain, FewIterations) {
  for (const int axis : {0, 1, 2})
    for (const double thickness : {1.0, 0.77}) {
      const CutCells cells = ring(axis, thickness, 60);
      ElasticSystem system = make_system(cells, 0.02);
      add_supports(system, cells);
      RealView solution[2];
      for (const Preconditioner kind : {Preconditioner::multigrid, Preconditioner::muelu}) {
        LinearSolver solver(ExecSpace(), system, kind);
        solver.update();
        const RealView b = random_force(system, 6), x("x", system.num_dofs());
        const LinearSolveResult result = solver.solve(b, x, 1e-10 * norm(b), 200);
        std::printf("axis %d, thickness %g: %d unknowns, %d iterations\n", axis, thickness, system.num_free_dofs(),
                    result.iterations);
        EXPECT_TRUE(result.converged);
        EXPECT_LE(result.iterations, kind == Preconditioner::multigrid ? 20 : 80);
        EXPECT_LT(norm(difference(consistent(system, x), x)), 1e-12 * norm(x)) << "the solution is consistent";
        solution[kind == Preconditioner::muelu] = x;
      }
      EXPECT_LT(norm(difference(solution[0], solution[1])), 1e-8 * norm(solution[0]));
    }
}

/// The ring with one layer of cells on every level, refined towards its rim: down to an eighth of the largest ones.
CutCells quadtree(int axis, int n = 6, double slice = 0.03) {
  const double h = 1.0 / n;
  Grid grid = ring(axis, 1, n).grid;
  grid.slice = slice;
  grid.thickness = h;
  grid.middle = 0.5 * h;
  Vec3 low = Vec3::Zero(), high = Vec3::Ones(), base = Vec3::Zero(), top = Vec3::Zero();
  low[axis] = base[axis] = -h;  // beyond the layer
  high[axis] = top[axis] = 2 * h;
  const Solid solid =
      Solid::subtract(Solid::intersect(Solid::box(low, high, "box"), Solid::cylinder(base, top, 0.9, "rim")),
                      Solid::cylinder(base, top, 0.45, "bore"));
  return cut_refined(solid, grid, 0.9 * Vec3::Unit((axis + 1) % 3), 0.125, 0.3, 8);
}

/// Both nodes of a pair are free or have the same masters, which are free themselves; sizes of neighbours differ by one
/// level; leaves lie in one layer.
TEST(PlaneStrain, PairsOfAQuadtreeAreOne) {
  for (const int axis : {0, 1, 2}) {
    const CutCells cells = quadtree(axis);
    ASSERT_EQ(cells.num_levels(), 4);
    for (std::size_t e = 0; e < cells.cells.size(); ++e) {
      EXPECT_EQ(cells.cells[e][axis], 0);
      for (const int d : {(axis + 1) % 3, (axis + 2) % 3})
        for (const int side : {-1, 1}) {
          Index3 beside = cells.cells[e];
          beside[d] += side;
          for (int l = cells.level(static_cast<int>(e)) - 2; l >= 0; --l) {
            const int steps = cells.level(static_cast<int>(e)) - l;
            EXPECT_LT(cells.find(l, {beside[0] >> steps, beside[1] >> steps, beside[2] >> steps}), 0);
          }
        }
    }
    const ElasticSystem system = make_system(cells);
    const BodyMesh& mesh = system.meshes[0];
    for (const NodeConstraint& c : system.constraints) {
      double sum = 0;
      for (const auto& [master, weight] : c.masters) {
        EXPECT_LT(system.constraint_of_node[master], 0);
        EXPECT_EQ(mesh.nodes[master][axis], 0);
        sum += weight;
      }
      EXPECT_NEAR(sum, 1, 1e-14);
    }
    EXPECT_EQ(system.num_free_dofs(), 2 * (system.num_nodes - static_cast<int>(system.constraints.size())));
    const RealView x = consistent(system, random_vector(system.num_dofs(), 1));
    for (const auto& nodes : mesh.cell_nodes)
      for (int a = 0; a < 8; ++a)
        for (int i = 0; i < 3; ++i) EXPECT_EQ(x(dof_of(nodes[a], i)), x(dof_of(nodes[a & ~(1 << axis)], i)));
  }
}

/// Cells of all levels count for the slice: uniaxial strain has the energy (lambda + 2 mu) times the area times the
/// slice (area and cells are integrated to 1e-9).
TEST(PlaneStrain, EnergyOfAQuadtreeIsThatOfTheSlice) {
  const double slice = 0.03, area = pi / 4 * (0.9 * 0.9 - 0.45 * 0.45);
  for (const int axis : {0, 1, 2}) {
    const CutCells cells = quadtree(axis, 6, slice);
    const ElasticSystem system = make_system(cells);
    const BodyMesh& mesh = system.meshes[0];
    for (const int d : {(axis + 1) % 3, (axis + 2) % 3}) {
      RealView u("u", system.num_dofs());
      for (int n = 0; n < mesh.num_nodes; ++n) u(dof_of(n, d)) = cells.grid.to_global(mesh.node_position(n))[d];
      EXPECT_LT(norm(difference(u, consistent(system, u))), 1e-14 * norm(u));
      EXPECT_NEAR(dot(u, apply(system, u)) / (mesh.modulus * (mesh.law.lambda + 2 * mesh.law.mu) * area * slice), 1,
                  1e-8);
    }
  }
}

TEST(PlaneStrain, ProductsOfAQuadtreeAgree) {
  for (const int axis : {0, 1, 2}) {
    const CutCells cells = quadtree(axis);
    ElasticSystem system = make_system(cells);
    add_supports(system, cells);
    SCOPED_TRACE(axis);
    expect_same_products(system, 100);
  }
}

TEST(PlaneStrain, CoarseningOfAQuadtreeIsTheGalerkinProduct) {
  for (const int axis : {0, 1, 2}) {
    CutCells fine_cells = quadtree(axis);
    for (int level = 0; level < 5; ++level) {
      CutCells coarse_cells = coarse_cut_cells(fine_cells);
      const ElasticSystem fine = make_system(fine_cells, 0), coarse = make_system(coarse_cells, 0);
      const Transfer transfer = make_transfer(fine, coarse);
      const RealView x = consistent(coarse, random_vector(coarse.num_dofs(), 3));
      RealView Px("Px", fine.num_dofs()), galerkin("galerkin", coarse.num_dofs());
      prolongate_add(ExecSpace(), transfer, fine.dofs, x, Px);
      restrict_to(ExecSpace(), transfer, coarse.dofs, apply(fine, Px), galerkin);
      EXPECT_LT(norm(difference(apply(coarse, x), galerkin)), 1e-12 * norm(galerkin)) << axis << ", level " << level;
      fine_cells = std::move(coarse_cells);
    }
  }
}

TEST(PlaneStrain, FewIterationsOnAQuadtree) {
  for (const int axis : {0, 1, 2}) {
    const CutCells cells = quadtree(axis, 24);
    ElasticSystem system = make_system(cells);
    add_supports(system, cells);
    LinearSolver solver(ExecSpace(), system, Preconditioner::multigrid);
    solver.update();
    const RealView b = random_force(system, 6), x("x", system.num_dofs());
    const LinearSolveResult result = solver.solve(b, x, 1e-8 * norm(b), 100);
    std::printf("axis %d: %d unknowns, %d iterations\n", axis, system.num_free_dofs(), result.iterations);
    EXPECT_TRUE(result.converged);
    EXPECT_LE(result.iterations, 15);
  }
}

}  // namespace
}  // namespace cgcontact::test_plane_strain
