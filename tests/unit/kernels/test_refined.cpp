/// Bodies on locally refined grids: constraints of hanging nodes, operator, coarsening, solver.
#include <gtest/gtest.h>

#include "kernels/multigrid/coarsen.hpp"
#include "kernels/solver/linear_solver.hpp"
#include "tests/support/constrained_system.hpp"

namespace cgcontact::test_refined {
namespace {

using namespace test;

constexpr double eps = 2.2e-16;

struct Body {
  const char* name;
  CutCells cells;
  double volume;
  double tolerance;  ///< of the volume
};

/// Levels that meet in the bulk, at faces, edges and corners of bodies in odd positions.
std::vector<Body> bodies() {
  const Solid box = Solid::box(Vec3(0.1, 0.15, 0.2), Vec3(0.9, 0.8, 0.75), "box");
  const Solid ball = Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.4, "ball");
  const auto cut = [](const Solid& solid, double angle, const Vec3& point) {
    return cut_refined(solid, odd_grid(5, angle), point, 1. / 8, 0.5);
  };
  return {{"box", cut(box, 0, Vec3(0.9, 0.4, 0.5)), 0.8 * 0.65 * 0.55, 1e-12},
          {"turned box", cut(box, 0.3, Vec3(0.9, 0.8, 0.75)), 0.8 * 0.65 * 0.55, 1e-12},
          {"ball", cut(ball, 0.7, Vec3(0.5, 0.5, 0.9)), 4. / 3 * pi * 0.064, 1e-5}};
}

Vec3 linear(const Vec3& x) {
  Mat3 gradient;
  gradient << 0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.25, 0.15, -0.6;
  return gradient * x + Vec3(0.2, -0.1, 0.3);
}

TEST(Refined, ConstraintsKeepLinearFields) {
  for (const Body& body : bodies()) {
    const ElasticSystem system = make_system(body.cells);
    ASSERT_GE(body.cells.num_levels(), 3) << body.name;
    EXPECT_GT(system.constraints.size(), 20u);
    const RealView u = nodal_field(system, linear);
    EXPECT_LT(norm(difference(consistent(system, u), u)), 10 * eps * norm(u)) << body.name;
    for (const NodeConstraint& c : system.constraints)
      for (const auto& [master, weight] : c.masters) {
        EXPECT_LT(system.constraint_of_node[master], 0) << "a master is constrained";
        EXPECT_TRUE(weight == 1 || weight == 0.5 || weight == 0.25 || weight == 0.125 || weight == 0.0625 ||
                    weight == 0.375 || weight == 0.1875)
            << weight;
      }
  }
}

/// A consistent field takes the same value from both sides of a face, an edge or a corner where levels meet.
TEST(Refined, ConsistentFieldsAreContinuous) {
  for (const Body& body : bodies()) {
    const ElasticSystem system = make_system(body.cells);
    const BodyMesh& mesh = system.meshes[0];
    const RealView u = consistent(system, random_vector(system.num_dofs(), 3));
    const auto value = [&](int cell, const Vec3& x) {
      double corners[8][3];
      corner_values(mesh.cell_nodes[cell], u, corners);
      return interpolate(corners, cell_coordinates(body.cells, cell, x));
    };
    int met = 0;
    for (int e = 0; e < static_cast<int>(body.cells.cells.size()); ++e)
      for (int d = 0; d < 3; ++d)
        for (int side = -1; side <= 1; side += 2)
          for (const double s : {-0.9, 0.1, 0.7}) {
            Vec3 xi(0.3, -0.6, 0.8), out;
            xi[(d + 1) % 3] = s;
            xi[d] = side;
            out = xi;
            out[d] *= 1 + 1e-3;
            const int other = body.cells.locate(grid_position(body.cells, e, out));
            if (other < 0 || other == e) continue;
            const Vec3 x = grid_position(body.cells, e, xi);
            if (cell_coordinates(body.cells, other, x).lpNorm<Eigen::Infinity>() > 1 + 1e-9) continue;
            met += body.cells.level(other) != body.cells.level(e);
            ASSERT_LT((value(e, x) - value(other, x)).norm(), 1e-14) << body.name;
          }
    EXPECT_GT(met, 100) << body.name;
  }
}

TEST(Refined, FastOperatorEqualsItsPlainReference) {
  for (const Body& body : bodies()) {
    ElasticSystem system = make_system(body.cells);
    std::vector<SupportTerm> terms;
    for (std::size_t p = 0; p < body.cells.boundary.size(); p += 5) {
      const int cell = body.cells.boundary.cell[p];
      terms.push_back(
          {cell, cell_coordinates(body.cells, cell, body.cells.boundary.position[p]), Vec3(1, 2, 2) / 3, 0.7});
    }
    add_support_terms(system, 0, terms);
    SCOPED_TRACE(body.name);
    expect_same_products(system, 1000);
  }
}

TEST(Refined, RigidMotionsCauseNoForceAndLinearFieldsTheirEnergy) {
  for (const Body& body : bodies()) {
    const ElasticSystem system = make_system(body.cells);
    for (int m = 0; m < 6; ++m) {
      const RealView u = nodal_field(system, [m](const Vec3& x) -> Vec3 {
        return m < 3 ? Vec3(Vec3::Unit(m)) : Vec3(Vec3::Unit(m - 3).cross(x));
      });
      EXPECT_LT(norm(apply(system, u)), 1000 * eps * norm(u)) << body.name << " mode " << m;
    }
    const RealView u = nodal_field(system, linear);
    Mat3 gradient;
    for (int d = 0; d < 3; ++d) gradient.col(d) = linear(Vec3::Unit(d)) - linear(Vec3::Zero());
    const Mat3 strain = 0.5 * (gradient + gradient.transpose());
    const UnitElasticity law(0.3);
    const double density = law.lambda * std::pow(strain.trace(), 2) + 2 * law.mu * strain.squaredNorm();
    EXPECT_NEAR(dot(u, apply(system, u)) / (2.0 * density * body.volume), 1, 5 * body.tolerance) << body.name;
  }
}

/// The jump of a bent field is seen across faces between levels too.
TEST(Refined, GhostPenaltyReachesAcrossLevels) {
  for (const Body& body : bodies()) {
    const ElasticSystem with = make_system(body.cells, 1.0);
    std::size_t faces = 0;
    for (const BodyMesh* level : with.level_meshes()) faces += level->level_faces.size();
    EXPECT_GT(faces, 3u) << body.name;
    ElasticSystem without = with;
    for (BodyMesh& level : without.meshes[0].level_meshes) level.level_faces.clear();
    const RealView u = nodal_field(with, linear);
    EXPECT_LT(norm(difference(apply(with, u), apply(without, u))), 1000 * eps * norm(apply(with, u)));
    const RealView bent =
        consistent(with, nodal_field(with, [](const Vec3& x) { return Vec3(x[0] * x[0], x[1] * x[1], 0); }));
    EXPECT_GT(dot(bent, apply(with, bent)), dot(bent, apply(without, bent)) * (1 + 1e-6)) << body.name;
  }
}

TEST(Refined, CoarseningIsTheGalerkinProduct) {
  for (const Body& body : bodies()) {
    const CutCells coarse_cells = coarse_cut_cells(body.cells);
    EXPECT_EQ(coarse_cells.num_levels(), body.cells.num_levels() - 1);
    const ElasticSystem fine = make_system(body.cells, 0), coarse = make_system(coarse_cells, 0);
    EXPECT_LT(coarse.num_nodes, 0.8 * fine.num_nodes);
    const Transfer transfer = make_transfer(fine, coarse);
    const RealView x = consistent(coarse, random_vector(coarse.num_dofs(), 3)), f = random_force(fine, 5);
    RealView Px("Px", fine.num_dofs()), Rf("Rf", coarse.num_dofs()), galerkin("galerkin", coarse.num_dofs());
    prolongate_add(ExecSpace(), transfer, fine.dofs, x, Px);
    restrict_to(ExecSpace(), transfer, coarse.dofs, f, Rf);
    EXPECT_NEAR(dot(Px, f), dot(x, Rf), 1e-13 * norm(Px) * norm(f)) << body.name << ": adjoint";
    restrict_to(ExecSpace(), transfer, coarse.dofs, apply(fine, Px), galerkin);
    const RealView Ax = apply(coarse, x);
    EXPECT_LT(norm(difference(galerkin, Ax)), 1e-12 * norm(Ax)) << body.name;
    RealView linear_fine("linear", fine.num_dofs());
    prolongate_add(ExecSpace(), transfer, fine.dofs, nodal_field(coarse, linear), linear_fine);
    const RealView exact = nodal_field(fine, linear);
    EXPECT_LT(norm(difference(linear_fine, exact)), 1e-13 * norm(exact)) << body.name;
  }
}

/// Two bodies, one refined to 8 levels towards a point of its surface, held weakly at one side, one of one level.
TEST(Refined, FewIterationsWithManyLevels) {
  for (const double angle : {0.0, 0.2, 0.6})
    for (const double contrast : {1.0, 1e3, 1e-3}) {
      const Solid block = Solid::box(Vec3(0.05, 0.1, 0), Vec3(0.9, 0.8, 1), "block");
      const CutCells refined = cut_refined(block, odd_grid(6, angle), Vec3(0.4, 0.45, 1), 1. / 128, 0.3);
      const CutCells uniform = cut(Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.4, "ball"), odd_grid(9, angle));
      ASSERT_EQ(refined.num_levels(), 8);
      ElasticSystem system = make_elastic_system({&refined, &uniform}, {Material{1, 0.3}, Material{contrast, 0.3}},
                                                 Scales{1. / 6, std::max(1.0, contrast)}, 0.02);
      for (int b = 0; b < 2; ++b) {
        const CutCells& cells = b == 0 ? refined : uniform;
        std::vector<SupportTerm> terms;
        for (std::size_t p = 0; p < cells.boundary.size(); ++p) {
          if (cells.grid.to_global(cells.boundary.position[p])[2] > 0.3) continue;
          const int cell = cells.boundary.cell[p];
          const double size = cells.size(cell);
          for (int d = 0; d < 3; ++d)
            terms.push_back({cell, cell_coordinates(cells, cell, cells.boundary.position[p]), Vec3::Unit(d),
                             10 * system.meshes[b].modulus * cells.boundary.weight[p] / size});
        }
        add_support_terms(system, b, terms);
      }
      LinearSolver solver(ExecSpace(), system, Preconditioner::multigrid);
      solver.update();
      const RealView b = random_force(system, 6), x("x", system.num_dofs());
      const LinearSolveResult result = solver.solve(b, x, 1e-8 * norm(b), 100);
      std::printf("angle %.1f, contrast %g: %d unknowns, %d levels of multigrid, %d iterations\n", angle, contrast,
                  system.num_dofs() - 3 * static_cast<int>(system.constraints.size()),
                  static_cast<int>(solver.report().unknowns.size()), result.iterations);
      EXPECT_TRUE(result.converged);
      EXPECT_LE(result.iterations, 15);
      // No grid costs more than the finest; some repeat too much of the next finer one and are passed by.
      const PreconditionerReport report = solver.report();
      int passed_by = 0;
      for (std::size_t l = 1; l + 1 < report.unknowns.size(); ++l) {
        EXPECT_LE(report.cycles[l] * report.unknowns[l], report.cycles[0] * report.unknowns[0]) << "level " << l;
        passed_by += report.cycles[l] == 0;
      }
      EXPECT_GT(passed_by, 0);
      EXPECT_GT(report.cycles.back(), 0);
      EXPECT_LT(norm(difference(consistent(system, x), x)), 1e-12 * norm(x)) << "the solution is consistent";
    }
}

}  // namespace
}  // namespace cgcontact::test_refined
