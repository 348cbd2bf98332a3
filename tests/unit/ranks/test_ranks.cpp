/// One system on several ranks against the same system whole, which every rank has too. Run by mpirun with 1 to 4 ranks
/// (tests/CMakeLists.txt); on one rank there is nothing to compare but the functions of ranks.hpp.
#include <gtest/gtest.h>

#include <Tpetra_Core.hpp>
#include <numeric>

#include "core/base/errors/errors.hpp"
#include "core/base/process/ranks.hpp"
#include "kernels/mesh/row_sums.hpp"
#include "kernels/multigrid/multigrid.hpp"
#include "kernels/multigrid/surface_matrix.hpp"
#include "kernels/ranks/rank_share.hpp"
#include "kernels/solver/linear_solver.hpp"
#include "tests/support/constrained_system.hpp"

namespace cgcontact::test_ranks {
namespace {

using test::consistent;
using test::difference;
using test::norm;
using test::random_force;

/// Two bodies with supports and rows of contact groups across both, some of them closed.
struct Problem {
  std::string name;
  std::vector<CutCells> cells;
  ElasticSystem system;

  /// num_rows: about so many, of cells from the first one on, of which `part` (0 to 1) have any.
  Problem(std::string label, std::vector<CutCells> bodies, int num_rows = 40, double part = 1)
      : name(std::move(label)), cells(std::move(bodies)) {
    std::vector<const CutCells*> pointers;
    std::vector<Material> materials;
    for (const CutCells& body : cells) {
      pointers.push_back(&body);
      materials.push_back({materials.empty() ? 1.0 : 3.0, 0.3});
    }
    system = make_elastic_system(pointers, materials, Scales{cells[0].grid.cell_size, 1.0}, 0.01);
    for (std::size_t b = 0; b < cells.size(); ++b) hold(static_cast<int>(b));
    add_rows(num_rows, part);
  }

  /// Lets the force of every other row depend on the gap of the one before, elsewhere on the surface.
  void couple() {
    std::vector<double> coupling;
    for (std::size_t r = 0; r < system.group_rows.size(); ++r) coupling.push_back(r % 2 == 0 ? 0.0 : 1.5);
    set_group_coupling(system, coupling);
  }

 private:
  void hold(int b) {
    const CutCells& body = cells[b];
    std::vector<SupportTerm> terms;
    for (std::size_t p = 0; p < body.boundary.size(); p += 2) {
      const int cell = body.boundary.cell[p];
      const Vec3 xi = cell_coordinates(body, cell, body.boundary.position[p]);
      const bool thin = name == "plate";  // the smoother holds its supports together
      for (int d = 0; d < 3; ++d)
        if (d != body.grid.plane_strain) terms.push_back({cell, xi, Vec3::Unit(d), 5 * body.boundary.weight[p], thin});
    }
    add_support_terms(system, b, terms);
  }

  /// Adds rows of cells of the first body, and of another of its cells in any order where there is one: rows that no
  /// rank owns alone.
  void add_rows(int num_rows, double part) {
    std::vector<GroupRow> rows;
    const std::vector<const BodyMesh*> parts = system.level_meshes();
    const auto entries_of = [&](const BodyMesh& level, int cell, double sign, GroupRow& row) {
      for (const int node : level.cell_nodes[cell])
        for (int i = 0; i < 3; ++i)
          if (i != level.cut_cells->grid.plane_strain)
            row.entries.emplace_back(dof_of(node, i), sign * (0.05 + 0.02 * i));
    };
    const BodyMesh &first = *parts.front(), &last = *parts.back();
    const int end = static_cast<int>(part * static_cast<double>(first.cell_nodes.size()));
    const int step = std::max(1, end / num_rows);
    for (int cell = 0; cell < end; cell += step) {
      GroupRow row;
      row.cell = cell;
      entries_of(first, cell, 1, row);
      const int other = static_cast<int>(last.cell_nodes.size()) - 1 - cell % static_cast<int>(last.cell_nodes.size());
      if (&last != &first) entries_of(last, other, -1, row);
      std::sort(row.entries.begin(), row.entries.end());
      row.coupled = static_cast<int>(rows.size()) - 1;
      rows.push_back(std::move(row));
    }
    set_group_rows(system, rows);
    std::vector<double> stiffness;
    for (std::size_t r = 0; r < rows.size(); ++r) stiffness.push_back(r % 3 == 0 ? 0.0 : 5.0);
    system.full_group_stiffness.assign(rows.size(), 5.0);
    set_group_stiffness(system, stiffness);
  }
};

CutCells ring_in_plane_strain(int n) {
  Grid grid;
  grid.cell_size = 1.0 / n;
  grid.plane_strain = 2;
  grid.num_cells = {n + 2, n + 2, 1};
  grid.origin = -grid.cell_size * Vec3(std::sqrt(2.0) - 1.2, std::sqrt(3.0) - 1.5, 0);
  const Solid quarter = Solid::intersect(Solid::box(Vec3::Zero(), Vec3(1, 1, grid.cell_size), "box"),
                                         Solid::cylinder(Vec3(0, 0, -1), Vec3(0, 0, 1), 0.9, "rim"));
  return test::cut(Solid::subtract(quarter, Solid::cylinder(Vec3(0, 0, -1), Vec3(0, 0, 1), 0.45, "bore")), grid);
}

/// Uniform grids, levels that meet inside and at the surface, plane strain, a thin plate (columns of nodes), two
/// bodies of which one has fewer cells than there are ranks, ranks without contact.
std::vector<Problem> problems() {
  const Solid ball = Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.42, "ball");
  const Solid box = Solid::box(Vec3(0.1, 0.15, 0.2), Vec3(0.9, 0.8, 0.75), "box");
  const Solid plate = Solid::box(Vec3(0, 0, 0), Vec3(1, 1, 0.12), "plate");
  const Solid crumb = Solid::sphere(Vec3(0.5, 0.5, 1.0), 0.04, "crumb");
  std::vector<Problem> all;
  const auto add = [&](const char* name, std::vector<CutCells> cells, double part = 1) {
    all.emplace_back(name, std::move(cells), 40, part);
  };
  all.reserve(8);
  add("ball", {test::cut(ball, test::odd_grid(13, 0.4))});
  add("ball and box", {test::cut(ball, test::odd_grid(11, 0.7)), test::cut(box, test::odd_grid(9, 0.2))});
  add("refined ball and box", {test::cut_refined(ball, test::odd_grid(6, 0.7), Vec3(0.5, 0.5, 0.9), 1. / 8, 0.5),
                               test::cut_refined(box, test::odd_grid(5, 0), Vec3(0.9, 0.4, 0.5), 1. / 4, 0.5)});
  add("plane strain", {ring_in_plane_strain(17)});
  add("plate", {test::cut(plate, test::odd_grid(16, 0))});
  add("ball and crumb", {test::cut(ball, test::odd_grid(12, 0.4)), test::cut(crumb, test::odd_grid(12, 0))});
  add("contact at one end", {test::cut(box, test::odd_grid(14, 0.2))}, 0.05);
  return all;
}

/// The share of this rank, of the whole finest grid.
std::unique_ptr<RankShare> share_of(const ElasticSystem& system) {
  auto share = std::make_unique<RankShare>(system, partition(system, num_ranks(), {}),
                                           std::vector<char>(system.num_nodes, 0), Tpetra::getDefaultComm());
  share->set_groups(system.group_rows, group_stiffness(system), false);
  share->take_coupling(system);
  return share;
}

RealView to_local(const RankShare& share, const RealView& whole) {
  const RealView local("local", share.system().num_dofs());
  share.to_local(whole, local);
  return local;
}

RealView to_whole(const RankShare& share, const RealView& local, const ElasticSystem& system) {
  const RealView whole("whole", system.num_dofs());
  share.to_whole(local, whole);
  return whole;
}

TEST(Ranks, SharesAreDisjointAndCoverAll) {
  for (const std::size_t n : {0, 1, 3, 17, 1000}) {
    const auto [begin, end] = share_out(n);
    double sum = static_cast<double>(end - begin);
    sum_over_ranks(&sum, 1);
    EXPECT_EQ(sum, static_cast<double>(n));
    std::vector<int> values(n, -1);
    for (std::size_t i = begin; i < end; ++i) values[i] = static_cast<int>(7 * i);
    put_together(values);
    for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(values[i], static_cast<int>(7 * i));
  }
  const std::vector<int> all = gather(std::vector<int>(this_rank() + 1, this_rank()));
  std::size_t at = 0;
  for (int r = 0; r < num_ranks(); ++r)
    for (int k = 0; k <= r; ++k) EXPECT_EQ(all.at(at++), r);
  EXPECT_EQ(at, all.size());
}

// Moments that each rank has kept its own part of are, gathered again, what they were, on all levels; in between their
// volumes are known.
TEST(Ranks, MomentsComeBack) {
  for (const Problem& problem : problems())
    for (const CutCells& whole : problem.cells) {
      CutCells cells = whole;
      cells.keep_own_moments();
      EXPECT_LE(cells.moments.size(), whole.moments.size() / num_ranks() + 1);
      for (std::size_t c = 0; c < whole.cells.size(); ++c)
        EXPECT_EQ(cells.volume_fraction(static_cast<int>(c)), whole.volume_fraction(static_cast<int>(c)));
      cells.gather_moments();
      ASSERT_EQ(cells.moments.size(), whole.moments.size());
      for (std::size_t cut = 0; cut < whole.moments.size(); ++cut) EXPECT_EQ(cells.moments[cut], whole.moments[cut]);
      for (std::size_t p = 0; p < whole.level_cells.size(); ++p) {
        const CutCells &part = cells.level_cells[p], &before = whole.level_cells[p];
        ASSERT_EQ(part.moments.size(), before.moments.size());
        for (std::size_t cut = 0; cut < before.moments.size(); ++cut) EXPECT_EQ(part.moments[cut], before.moments[cut]);
      }
    }
}

TEST(Ranks, AnErrorOfTheFirstRankIsAnErrorOfAll) {
  const auto fail = [] { throw InputError("no such file"); };
  if (is_first_rank())
    EXPECT_THROW(on_first_rank(fail), InputError);
  else
    EXPECT_THROW(on_first_rank(fail), OtherRankFailed);
  EXPECT_EQ(text_of_first_rank(is_first_rank() ? "abc" : "def"), "abc");
}

TEST(Ranks, EveryFreeNodeHasOneOwner) {
  if (num_ranks() == 1) GTEST_SKIP() << "one rank";
  for (const Problem& problem : problems()) {
    const auto share = share_of(problem.system);
    double owned = share->system().dofs.halo()->num_owned();
    sum_over_ranks(&owned, 1);
    EXPECT_EQ(owned, problem.system.num_nodes - static_cast<double>(problem.system.constraints.size())) << problem.name;
    // there and back
    const RealView x = random_force(problem.system, 3);
    EXPECT_EQ(norm(difference(to_whole(*share, to_local(*share, x), problem.system), x)), 0) << problem.name;
  }
}

/// Ghost nodes get the value of their owner, and what constraints then give is what they give on the whole.
TEST(Ranks, DisplacementsAreConsistent) {
  if (num_ranks() == 1) GTEST_SKIP() << "one rank";
  for (const Problem& problem : problems()) {
    const auto share = share_of(problem.system);
    const RealView x = consistent(problem.system, test::random_vector(problem.system.num_dofs(), 4));
    const RealView expected = to_local(*share, x), own = to_local(*share, x);
    const Halo& halo = *share->system().dofs.halo();
    for (std::size_t n = 0; n < halo.others().extent(0); ++n)
      for (int i = 0; i < 3; ++i) own(dof_of(halo.others()(n), i)) = 1e30;
    apply_constraints(ExecSpace(), share->system().dofs, own);
    int checked = 0;
    for (std::size_t p = 0; p < share->system().level_meshes().size(); ++p) {
      const BodyMesh& part = *share->system().level_meshes()[p];
      for (const auto& nodes : part.cell_nodes) {
        if (std::none_of(nodes.begin(), nodes.end(), [&](int node) { return halo.needs(node); })) continue;
        for (const int node : nodes)
          for (int i = 0; i < 3; ++i, ++checked)
            ASSERT_NEAR(own(dof_of(node, i)), expected(dof_of(node, i)), 1e-14) << problem.name;
      }
    }
    double all = checked;
    sum_over_ranks(&all, 1);
    EXPECT_GT(all, 0);
  }
}

/// Rounding of sums in another order: 1e-13 of the whole.
TEST(Ranks, OperatorIsThatOfTheWhole) {
  if (num_ranks() == 1) GTEST_SKIP() << "one rank";
  for (Problem& problem : problems()) {
    problem.couple();
    const auto share = share_of(problem.system);
    const RealView x = consistent(problem.system, test::random_vector(problem.system.num_dofs(), 5));
    const RealView expected = test::apply(problem.system, x);
    const RealView own_x = to_local(*share, x);
    apply_constraints(ExecSpace(), share->system().dofs, own_x);
    const RealView own_y = test::apply(share->system(), own_x);
    EXPECT_LT(norm(difference(to_whole(*share, own_y, problem.system), expected)), 1e-13 * norm(expected))
        << problem.name;
    double energy = test::dot(own_x, own_y);
    sum_over_ranks(&energy, 1);
    EXPECT_NEAR(energy, test::dot(x, expected), 1e-13 * std::abs(energy)) << problem.name;
  }
}

/// Parts of rows that some ranks have, added up: the same bits on all of them, in the order of the ranks.
TEST(Ranks, SumsOfSharedRows) {
  if (num_ranks() == 1) GTEST_SKIP() << "one rank";
  constexpr int num_rows = 30;
  const auto has = [](int row, int rank) { return row % 5 == 0 ? rank == 1 : (row + rank) % 3 != 0; };
  const auto part = [](int row, int rank) { return 0.1 * row + 1.0 / (rank + 3); };
  std::vector<int> own;
  for (int row = 0; row < num_rows; ++row)
    if (has(row, this_rank())) own.push_back(row);
  const std::vector<RowPart> parts = parts_of_shared_rows(own);
  std::vector<int> wanted;  // also rows of others
  for (const RowPart& p : parts) {
    EXPECT_NE(p.row % 5, 0);
    EXPECT_TRUE(has(p.row, p.rank));
    if (p.row % 2 == 0 && (wanted.empty() || wanted.back() != p.row)) wanted.push_back(p.row);
  }
  const RowSums sums(Tpetra::getDefaultComm(), parts, wanted);
  const RealView values("values", num_rows);
  for (const int row : own) values(row) = part(row, this_rank());
  sums.sum(ExecSpace(), values.data());
  ExecSpace().fence();
  for (const int row : wanted) {
    double expected = 0;
    for (int rank = 0; rank < num_ranks(); ++rank)
      if (has(row, rank)) expected += part(row, rank);
    EXPECT_EQ(values(row), expected) << row;
  }
}

/// A chain of rows, of which each rank has a stretch: the inverse of the whole, by messages to both neighbours at most
/// where the stretches are long, and by none where one rank has all.
TEST(Ranks, SurfaceMatrixIsThatOfTheWhole) {
  if (num_ranks() == 1) GTEST_SKIP() << "one rank";
  for (const auto& [num_rows, first_rank_alone] :
       {std::pair{7, false}, std::pair{60, false}, std::pair{1600, false}, std::pair{60, true}}) {
    SurfaceMatrix<double>::Entries whole, own;
    const RealView all("all", num_rows), g("g", num_rows);
    std::vector<char> is_own(num_rows, 0);
    for (int row = 0; row < num_rows; ++row) whole.emplace_back(row, row, 1);
    for (int row = 0; row + 1 < num_rows; ++row) {
      const int rank = first_rank_alone ? 0 : row * num_ranks() / num_rows;
      const double k = 2 + row % 3;
      for (auto* entries : {&whole, &own}) {
        if (entries == &own && rank != this_rank()) continue;
        entries->emplace_back(row, row, k);
        entries->emplace_back(row + 1, row + 1, k);
        entries->emplace_back(row + 1, row, 0.9 * k);
      }
      for (const RealView& vector : {all, g}) {
        if (vector.data() == g.data() && rank != this_rank()) continue;
        vector(row) += 1 + 0.1 * row;
        vector(row + 1) -= 0.3;
        if (vector.data() == g.data()) is_own[row] = is_own[row + 1] = 1;
      }
    }
    const SurfaceMatrix<double> matrix(num_rows, own, Tpetra::getDefaultComm());
    SurfaceMatrix<double>(num_rows, whole).solve(ExecSpace(), all);
    const double before = work_of_rank().messages;
    matrix.solve(ExecSpace(), g);
    const double messages = work_of_rank().messages - before;
    for (int row = 0; row < num_rows; ++row)
      if (is_own[row]) {
        EXPECT_NEAR(g(row), all(row), 1e-12 * (1 + 0.1 * num_rows)) << num_rows << ", " << row;
      }
    EXPECT_LE(messages, first_rank_alone ? 0 : num_rows == 1600 ? 2 : num_ranks() - 1);
  }
}

/// What iterations have taken.
struct Work {
  double sums, bytes;
  std::vector<long long> cycles;
};

Work work_of_iterations(const ElasticSystem& system, int count) {
  LinearSolver solver(ExecSpace(), system, Preconditioner::multigrid, 0);
  solver.update();
  const RealView b = random_force(system, 8), x("x", b.extent(0));
  const RankWork before = work_of_rank();
  EXPECT_EQ(solver.solve(b, x, 0, count).iterations, count);
  const RankWork& now = work_of_rank();
  return {now.reductions - before.reductions, now.reduced_bytes - before.reduced_bytes, solver.report().cycles};
}

/// A CG iteration takes four sums over all ranks, and each step on a coarse grid one to three; they are scalar
/// products, however many contact rows there are, and whether a rank has any.
TEST(Ranks, SumsOverAllRanksAreFewAndSmall) {
  if (num_ranks() == 1) GTEST_SKIP() << "one rank";
  constexpr int most_at_once = 5;  // products
  const Solid ball = Solid::sphere(Vec3(0.5, 0.5, 0.5), 0.42, "ball");
  const Solid box = Solid::box(Vec3(0.1, 0.15, 0.2), Vec3(0.9, 0.8, 0.75), "box");
  for (const auto& [num_rows, part] : {std::pair{40, 1.0}, std::pair{1000, 1.0}, std::pair{100, 0.05}}) {
    const Problem problem("ball and box",
                          {test::cut(ball, test::odd_grid(22, 0.7)), test::cut(box, test::odd_grid(18, 0.2))}, num_rows,
                          part);
    const Work two = work_of_iterations(problem.system, 2), three = work_of_iterations(problem.system, 3);
    ASSERT_GT(three.cycles.size(), 2u);
    double steps = 0;
    for (std::size_t l = 1; l + 1 < three.cycles.size(); ++l)
      steps += static_cast<double>(three.cycles[l] - two.cycles[l]);
    const double sums = three.sums - two.sums;
    EXPECT_GE(sums, 4 + steps) << num_rows;
    EXPECT_LE(sums, 4 + 2 * steps) << num_rows;
    EXPECT_LE(sums, 10) << num_rows;
    EXPECT_LE(three.bytes - two.bytes, sums * most_at_once * sizeof(double)) << num_rows;
  }
}

RealView cycle(const Multigrid& multigrid, const RealView& r) {
  const RealView own = multigrid.share() ? to_local(*multigrid.share(), r) : r;
  if (multigrid.share()) zero_others(ExecSpace(), multigrid.share()->system().dofs, own);
  TpetraVector in(multigrid.getDomainMap(), 1), out(multigrid.getDomainMap(), 1);
  {
    const auto host = in.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t i = 0; i < own.extent(0); ++i) host(i, 0) = own(i);
  }
  multigrid.apply(in, out, Teuchos::NO_TRANS, 1, 0);
  const RealView z("z", own.extent(0));
  const auto host = out.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t i = 0; i < own.extent(0); ++i) z(i) = host(i, 0);
  if (!multigrid.share()) return z;
  const RealView whole("whole", r.extent(0));
  multigrid.share()->to_whole(z, whole);
  return whole;
}

/// One V-cycle, in single precision: rounding, ten times as much where a coarse system is nearly singular.
TEST(Ranks, CycleIsThatOfTheWhole) {
  if (num_ranks() == 1) GTEST_SKIP() << "one rank";
  for (const Problem& problem : problems()) {
    MultigridSettings settings;
    settings.coarsest_unknowns = 100;
    settings.coarse_steps = 0;
    settings.shared_unknowns = 1 << 30;
    const Multigrid whole(problem.system, settings);
    ASSERT_EQ(whole.share(), nullptr);
    const RealView r = random_force(problem.system, 6);
    const RealView expected = cycle(whole, r);
    for (const int shared : {0, 400}) {  // as many levels as there are, or some
      settings.shared_unknowns = shared;
      const Multigrid divided(problem.system, settings);
      ASSERT_NE(divided.share(), nullptr) << problem.name;
      RealView z = cycle(divided, r);
      apply_constraints(ExecSpace(), problem.system.dofs, z);
      EXPECT_LT(norm(difference(z, expected)), 1e-4 * norm(expected)) << problem.name << ", " << shared;
      for (std::size_t l = 0; l < whole.report().largest_eigenvalue.size(); ++l)
        EXPECT_NEAR(divided.report().largest_eigenvalue[l], whole.report().largest_eigenvalue[l], 1e-3) << problem.name;
    }
  }
}

/// By CG, and by GMRES where rows are coupled.
TEST(Ranks, SolutionIsThatOfTheWhole) {
  if (num_ranks() == 1) GTEST_SKIP() << "one rank";
  for (Problem& problem : problems())
    for (const bool coupled : {false, true}) {
      if (coupled) problem.couple();
      const std::string name = problem.name + (coupled ? ", coupled" : "");
      const RealView b = random_force(problem.system, 7);
      const double tolerance = 1e-10 * norm(b);
      RealView solution[2];
      int iterations[2];
      for (const int divided : {0, 1}) {
        LinearSolver solver(ExecSpace(), problem.system, Preconditioner::multigrid, divided ? 0 : 1 << 30);
        solver.update();
        solution[divided] = RealView("x", b.extent(0));
        const LinearSolveResult result = solver.solve(b, solution[divided], tolerance, 200);
        EXPECT_TRUE(result.converged) << name;
        iterations[divided] = result.iterations;
        const double energy = solver.energy(solution[divided]);
        EXPECT_NEAR(energy, test::dot(solution[divided], b), 1e-9 * energy) << name;
      }
      EXPECT_NEAR(iterations[1], iterations[0], 1) << name;
      EXPECT_LT(norm(difference(solution[1], solution[0])), 1e-7 * norm(solution[0])) << name;
    }
}

}  // namespace
}  // namespace cgcontact::test_ranks
