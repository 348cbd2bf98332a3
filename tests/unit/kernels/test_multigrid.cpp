/// The grid hierarchy: coarse operators are Galerkin products, transfers are adjoint, the V-cycle is symmetric and
/// positive, and CG needs as many iterations on fine grids as on coarse ones.
#include <gtest/gtest.h>

#include <Tpetra_Core.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "kernels/multigrid/coarsen.hpp"
#include "kernels/multigrid/multigrid.hpp"
#include "kernels/reference/plain_operator.hpp"
#include "kernels/solver/linear_solver.hpp"
#include "tests/support/bodies.hpp"

namespace cgcontact::test_multigrid {
namespace {

using test::dot;
using test::norm;

struct TwoLevels {
  CutCells fine_cells, coarse_cells;
  ElasticSystem fine, coarse;
  Transfer transfer;
  TwoLevels(const Solid& solid, int n, double angle, double ghost_penalty)
      : fine_cells(test::cut(solid, test::odd_grid(n, angle))), coarse_cells(coarse_cut_cells(fine_cells)) {
    fine = make_elastic_system({&fine_cells}, {Material{2.0, 0.3}}, Scales{0.5, 4.0}, ghost_penalty);
    coarse = make_elastic_system({&coarse_cells}, {Material{2.0, 0.3}}, Scales{0.5, 4.0}, ghost_penalty);
    transfer = make_transfer(fine, coarse);
  }
};

Solid ball() { return Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.45, "ball"); }
Solid block() { return Solid::box(Vec3(0.05, 0.1, 0), Vec3(0.9, 0.8, 1), "block"); }

TEST(Coarsening, StiffnessIsTheGalerkinProduct) {
  for (const Solid& solid : {ball(), block()}) {
    const TwoLevels levels(solid, 9, 0.3, 0.0);
    const RealView x = test::random_vector(levels.coarse.num_dofs(), 3);
    RealView Px("Px", levels.fine.num_dofs()), APx("APx", levels.fine.num_dofs());
    RealView galerkin("galerkin", levels.coarse.num_dofs()), coarse("coarse", levels.coarse.num_dofs());
    prolongate_add(ExecSpace(), levels.transfer, levels.fine.dofs, x, Px);
    PlainOperator(levels.fine).apply(ExecSpace(), Px, APx);
    restrict_to(ExecSpace(), levels.transfer, levels.coarse.dofs, APx, galerkin);
    PlainOperator(levels.coarse).apply(ExecSpace(), x, coarse);
    for (std::size_t i = 0; i < x.extent(0); ++i) galerkin(i) -= coarse(i);
    EXPECT_LT(norm(galerkin), 1e-13 * norm(coarse));
  }
}

TEST(Coarsening, TransfersAreAdjointAndKeepLinearFields) {
  const TwoLevels levels(ball(), 9, 0.3, 0.01);
  const RealView c = test::random_vector(levels.coarse.num_dofs(), 4),
                 f = test::random_vector(levels.fine.num_dofs(), 5);
  RealView Pc("Pc", levels.fine.num_dofs()), Rf("Rf", levels.coarse.num_dofs());
  prolongate_add(ExecSpace(), levels.transfer, levels.fine.dofs, c, Pc);
  restrict_to(ExecSpace(), levels.transfer, levels.coarse.dofs, f, Rf);
  EXPECT_NEAR(dot(Pc, f), dot(c, Rf), 1e-13 * norm(Pc) * norm(f));
  const auto linear = [](const Vec3& x) { return Vec3(1 + x[0] - 2 * x[1], x[2], 3 * x[1] + x[0]); };
  const RealView coarse = test::nodal_field(levels.coarse, linear), exact = test::nodal_field(levels.fine, linear);
  RealView fine("fine", levels.fine.num_dofs());
  prolongate_add(ExecSpace(), levels.transfer, levels.fine.dofs, coarse, fine);
  for (std::size_t i = 0; i < fine.extent(0); ++i) fine(i) -= exact(i);
  EXPECT_LT(norm(fine), 1e-13 * norm(exact));
}

TEST(Coarsening, SupportsKeepTheirPointsAndHalveTheirStiffness) {
  TwoLevels levels(block(), 9, 0.3, 0.01);
  std::vector<SupportTerm> terms;
  const BoundaryPoints& points = levels.fine_cells.boundary;
  for (std::size_t p = 0; p < points.size(); p += 7) {
    const Index3& c = levels.fine_cells.cells[points.cell[p]];
    terms.push_back(
        {points.cell[p], 2 * (points.position[p] - Vec3(c[0], c[1], c[2])) - Vec3::Ones(), Vec3::UnitX(), 2});
  }
  add_support_terms(levels.fine, 0, terms);
  const auto coarse = coarse_supports(levels.fine, levels.coarse, false)[0];
  for (std::size_t t = 0; t < terms.size(); ++t) {
    const Index3& c = levels.coarse_cells.cells[coarse[t].cell];
    const Vec3 position = 2 * (Vec3(c[0], c[1], c[2]) + 0.5 * (coarse[t].xi + Vec3::Ones()));
    EXPECT_LT((position - points.position[7 * t]).norm(), 1e-13);
    EXPECT_EQ(coarse[t].stiffness, 1);
  }
}

/// A body held in all directions where z < 0.3.
struct HeldBody {
  CutCells cells;
  ElasticSystem system;
  HeldBody(const Solid& solid, int n, double angle, double kappa) : cells(test::cut(solid, test::odd_grid(n, angle))) {
    system = make_elastic_system({&cells}, {Material{1.0, 0.3}}, Scales{1.0 / n, 1.0}, 0.01);
    std::vector<SupportTerm> terms;
    for (std::size_t p = 0; p < cells.boundary.size(); ++p) {
      const Vec3 x = cells.grid.to_global(cells.boundary.position[p]);
      if (x[2] > 0.3) continue;
      const Index3& c = cells.cells[cells.boundary.cell[p]];
      const Vec3 xi = 2 * (cells.boundary.position[p] - Vec3(c[0], c[1], c[2])) - Vec3::Ones();
      for (int d = 0; d < 3; ++d)
        terms.push_back({cells.boundary.cell[p], xi, Vec3::Unit(d), kappa * cells.boundary.weight[p]});
    }
    add_support_terms(system, 0, terms);
  }
};

/// A plate between two supports; `thickness` in cells, across one axis of its grid or across none.
struct HeldPlate {
  CutCells cells;
  ElasticSystem system;
  HeldPlate(int n, double thickness, double offset, double angle, double kappa) {
    const double h = 1.0 / n;
    Grid grid = test::odd_grid(n, angle);
    if (angle == 0) {
      grid.origin = Vec3(-0.3 * h, -0.4 * h, -offset * h);
      grid.num_cells = {n + 2, n + 2, static_cast<int>(thickness + offset) + 1};
    }
    cells = test::cut(Solid::box(Vec3(0, 0, 0), Vec3(1, 1, thickness * h), "plate"), grid);
    system = make_elastic_system({&cells}, {Material{1.0, 0.3}}, Scales{1.0, 1.0}, 0.02);
    std::vector<SupportTerm> terms;
    const BoundaryPoints& points = cells.boundary;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Vec3 across = cells.grid.rotation.transpose() * Vec3(0, 0, 1);
      const bool side = std::abs(points.normal[p].dot(across)) > 0.9;
      const Index3& c = cells.cells[points.cell[p]];
      const Vec3 xi = 2 * (points.position[p] - Vec3(c[0], c[1], c[2])) - Vec3::Ones();
      const double stiffness = kappa * points.weight[p] * h;
      for (int d = 0; d < 3; ++d)
        if (side ? d == 0 : (cells.grid.rotation * points.normal[p])[0] < -0.9)
          terms.push_back({points.cell[p], xi, side ? across : Vec3(Vec3::Unit(d)), stiffness});
    }
    add_support_terms(system, 0, terms);
  }
};

TEST(Multigrid, FewIterationsOnThinBodiesHeldOnBothSides) {
  for (double angle : {0.0, 0.2, 0.5})
    for (double thickness : {0.7, 1.0, 2.0, 3.0})
      for (double offset : {0.0, 1e-6, 0.5, 1 - 1e-4}) {
        if (angle > 0 && offset > 0) continue;
        const HeldPlate plate(30, thickness, offset, angle, 30);
        LinearSolver solver(ExecSpace(), plate.system, Preconditioner::multigrid);
        solver.update();
        const RealView b = test::random_vector(plate.system.num_dofs(), 6), x("x", plate.system.num_dofs());
        const LinearSolveResult result = solver.solve(b, x, 1e-8 * norm(b), 100);
        std::printf("angle %.1f, %.1f cells, offset %.1e: %d unknowns, %d iterations\n", angle, thickness, offset,
                    plate.system.num_dofs(), result.iterations);
        EXPECT_TRUE(result.converged);
        EXPECT_LE(result.iterations, 15) << "angle " << angle << ", " << thickness << " cells, offset " << offset;
      }
}

/// Points are merged on the way down, but not the form that they integrate.
TEST(Coarsening, SupportsAreTheGalerkinProduct) {
  const HeldPlate plate(9, 1.3, 0.4, 0.2, 5);
  ElasticSystem fine = plate.system;
  CutCells cells[2] = {coarse_cut_cells(plate.cells), {}};
  cells[1] = coarse_cut_cells(cells[0]);
  RealView x = test::random_vector(make_elastic_system({&cells[1]}, fine.materials, fine.scales, 0).num_dofs(), 3);
  std::vector<ElasticSystem> systems{fine};
  for (const CutCells& coarse : cells) {
    systems.push_back(make_elastic_system({&coarse}, fine.materials, fine.scales, 0));
    systems.back().supports = coarse_supports(systems[systems.size() - 2], systems.back(), false);
  }
  EXPECT_LT(systems[2].supports[0].size(), systems[0].supports[0].size());
  const auto supports_only = [](const ElasticSystem& system, const RealView& u) {
    ElasticSystem without = system;
    without.supports[0].clear();
    RealView a("a", u.extent(0)), b("b", u.extent(0));
    PlainOperator(system).apply(ExecSpace(), u, a);
    PlainOperator(without).apply(ExecSpace(), u, b);
    for (std::size_t i = 0; i < a.extent(0); ++i) a(i) -= b(i);
    return a;
  };
  const Transfer first = make_transfer(systems[0], systems[1]), second = make_transfer(systems[1], systems[2]);
  RealView x1("x1", systems[1].num_dofs()), x0("x0", systems[0].num_dofs());
  prolongate_add(ExecSpace(), second, systems[1].dofs, x, x1);
  prolongate_add(ExecSpace(), first, systems[0].dofs, x1, x0);
  RealView r1("r1", systems[1].num_dofs()), r2("r2", systems[2].num_dofs());
  restrict_to(ExecSpace(), first, systems[1].dofs, supports_only(systems[0], x0), r1);
  restrict_to(ExecSpace(), second, systems[2].dofs, r1, r2);
  const RealView coarse = supports_only(systems[2], x);
  for (std::size_t i = 0; i < r2.extent(0); ++i) r2(i) -= 4 * coarse(i);  // kappa E / h of the coarse h
  EXPECT_LT(norm(r2), 1e-12 * norm(coarse) * 4);
}

/// One row in each cut cell, along its main diagonal.
std::vector<GroupRow> rows_of_cut_cells(const ElasticSystem& system) {
  const BodyMesh& mesh = system.meshes[0];
  std::vector<GroupRow> rows;
  for (const int cell : mesh.cut_cells->active_of_cut) {
    GroupRow row{{}, 0, cell, cell % 2};
    displacement_row(mesh.cell_nodes[cell], Vec3(0.2, -0.3, 0.1), Vec3(1, 2, 3).normalized(),
                     [&](int dof, double value) { row.entries.emplace_back(dof, value); });
    std::sort(row.entries.begin(), row.entries.end());
    rows.push_back(row);
  }
  return rows;
}

double product(const GroupRow& row, const RealView& x) {
  double sum = 0;
  for (const auto& [dof, value] : row.entries) sum += value * x(dof);
  return sum;
}

/// A coarse row is the mean of its members' P^T r, weighted with their stiffness, or as if closed where all are open;
/// what an update of some stiffnesses leaves as it is would have come out the same.
TEST(Coarsening, ContactRowsAreWeightedMeans) {
  const TwoLevels levels(ball(), 9, 0.3, 0.0);
  const std::vector<GroupRow> fine = rows_of_cut_cells(levels.fine);
  const RealView x = test::random_vector(levels.coarse.num_dofs(), 8);
  RealView Px("Px", levels.fine.num_dofs());
  prolongate_add(ExecSpace(), levels.transfer, levels.fine.dofs, x, Px);
  RowCoarsening coarsening(levels.fine, levels.coarse, levels.transfer, fine, nullptr);
  RowCoarsening::Present present;
  for (std::size_t r = 0; r < fine.size(); ++r) {
    present.stiffness.push_back(r % 3 == 0 || r < fine.size() / 4 ? 0 : 1 + 0.1 * (r % 7));
    present.full_stiffness.push_back(1 + 0.1 * (r % 7));
    present.changed.push_back(1);
  }
  std::vector<GroupRow> rows;
  const auto check = [&](const RowCoarsening::Present& coarse) {
    std::map<std::array<int, 2>, std::array<double, 4>> sums;  // cell, family: of k, k r P x, and the same closed
    for (std::size_t r = 0; r < fine.size(); ++r) {
      const CoarseCells::CoarseCell to_cell = CoarseCells(levels.fine, levels.coarse).of(0, fine[r].cell);
      auto& sum = sums[{to_cell.cell, fine[r].family}];
      sum[0] += present.stiffness[r];
      sum[1] += present.stiffness[r] * product(fine[r], Px);
      sum[2] += present.full_stiffness[r];
      sum[3] += present.full_stiffness[r] * product(fine[r], Px);
    }
    ASSERT_EQ(rows.size(), sums.size());
    int open = 0;
    for (std::size_t c = 0; c < rows.size(); ++c) {
      const auto& sum = sums.at({rows[c].cell, rows[c].family});
      const int which = sum[0] > 0 ? 0 : 2;
      open += which != 0;
      EXPECT_NEAR(product(rows[c], x), sum[which + 1] / sum[which], 1e-13);
      EXPECT_NEAR(coarse.stiffness[c], sum[0] / 2, 1e-13);
      EXPECT_NEAR(coarse.full_stiffness[c], sum[2] / 2, 1e-13);
    }
    EXPECT_GT(open, 0);
  };
  check(coarsening.update(fine, present, levels.coarse, rows));
  // Every fifth row opens or closes.
  present.changed.assign(fine.size(), 0);
  for (std::size_t r = 0; r < fine.size(); r += 5)
    present.stiffness[r] = present.stiffness[r] > 0 ? 0 : present.full_stiffness[r];
  const RowCoarsening::Present second = coarsening.update(fine, present, levels.coarse, rows);
  check(second);
  const auto changed = std::count(second.changed.begin(), second.changed.end(), 1);
  EXPECT_GT(changed, 0);
  EXPECT_LT(changed, static_cast<long>(rows.size()));
  // Entries of fine rows that have changed are seen as well.
  present.changed.assign(fine.size(), 1);
  EXPECT_TRUE(coarsening.update(fine, present, levels.coarse, rows).any_changed());
}

TEST(Multigrid, VCycleIsSymmetricAndPositive) {
  const HeldBody body(ball(), 14, 0.4, 10);
  const auto map = body.system.dofs.vector_map(Tpetra::getDefaultComm());
  MultigridSettings settings;
  settings.coarsest_unknowns = 300;
  settings.coarse_steps = 0;  // with steps of CG the cycle is not linear
  const Multigrid multigrid(body.system, settings);
  ASSERT_GE(multigrid.report().unknowns.size(), 3u);
  TpetraVector x(map, 1), y(map, 1), Bx(map, 1), By(map, 1);
  x.randomize();
  y.randomize();
  multigrid.apply(x, Bx, Teuchos::NO_TRANS, 1, 0);
  multigrid.apply(y, By, Teuchos::NO_TRANS, 1, 0);
  const double xBy = x.getVector(0)->dot(*By.getVector(0)), yBx = y.getVector(0)->dot(*Bx.getVector(0));
  const double xBx = x.getVector(0)->dot(*Bx.getVector(0));
  EXPECT_GT(xBx, 0);
  EXPECT_NEAR(xBy, yBx, 1e-5 * xBx);  // single precision inside
}

TEST(Multigrid, IterationsStayFlat) {
  std::vector<int> iterations;
  for (int n : {12, 24, 48}) {
    const HeldBody body(ball(), n, 0.4, 10);
    LinearSolver solver(ExecSpace(), body.system, Preconditioner::multigrid);
    solver.update();
    const RealView b = test::random_vector(body.system.num_dofs(), 6);
    const RealView x("x", body.system.num_dofs());
    const LinearSolveResult result = solver.solve(b, x, 1e-8 * norm(b), 100);
    EXPECT_TRUE(result.converged);
    EXPECT_LE(result.iterations, 9) << n;
    iterations.push_back(result.iterations);
  }
  EXPECT_LE(iterations[2], iterations[1] + 2);
}

TEST(Multigrid, SolutionIsThatOfMueLu) {
  const HeldBody body(block(), 16, 0.2, 10);
  const RealView b = test::random_vector(body.system.num_dofs(), 7);
  RealView x[2];
  for (const Preconditioner kind : {Preconditioner::multigrid, Preconditioner::muelu}) {
    RealView& u = x[kind == Preconditioner::muelu];
    u = RealView("u", body.system.num_dofs());
    LinearSolver solver(ExecSpace(), body.system, kind);
    solver.update();
    EXPECT_TRUE(solver.solve(b, u, 1e-12 * norm(b), 300).converged);
  }
  for (std::size_t i = 0; i < b.extent(0); ++i) x[0](i) -= x[1](i);
  EXPECT_LT(norm(x[0]), 1e-8 * norm(x[1]));  // tolerance times the condition number, about 1e4
}

}  // namespace
}  // namespace cgcontact::test_multigrid
