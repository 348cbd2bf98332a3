/// The linear solver on the paper's scene in 3D, all contact closed: one step of the smoother, one V-cycle, the set-up
/// of multigrid; and the whole way to the solution (set-up and CG to 1e-8 of the right-hand side, which is random),
/// with multigrid and, in the same run, as others would do it: matrix assembled, MueLu, the same CG on the assembled
/// matrix (`times_muelu`: its time over ours). Sizes are n of the scene: 26 makes 105,000 unknowns, 56 about a million.
///
/// solver/tree is the same way with multigrid for one block, held at its lower face, refined to 6 levels, in turns with
/// the block of as many unknowns on a uniform grid (`of_uniform`: the unknowns per second over the uniform grid's; of
/// set-up and solve alone too); sizes are cells along an edge of the latter. system_B/DoF: cells, mesh and system.
///
/// Memory (B/DoF, muelu_B/DoF) is the largest resident set during set-up and solve beyond that before them, when there
/// are the system and its right-hand side only (before_B/DoF); set_up_B/DoF is what the solver holds.
#include <Tpetra_Core.hpp>
#include <Tpetra_Vector.hpp>
#include <cmath>
#include <memory>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "kernels/assembled/muelu.hpp"
#include "kernels/multigrid/multigrid.hpp"
#include "kernels/multigrid/smoother.hpp"
#include "kernels/reference/plain_operator.hpp"
#include "kernels/solver/krylov.hpp"
#include "kernels/solver/linear_solver.hpp"
#include "perf/harness.hpp"
#include "perf/problems.hpp"
#include "perf/process_memory.hpp"

namespace {

using namespace cgcontact;
using namespace cgcontact::perf;
using Teuchos::RCP;
using Teuchos::rcp;

constexpr double tolerance = 1e-8;
constexpr int max_iterations = 500;

double dot(const RealView& x, const RealView& y) {
  double sum = 0;
  for (std::size_t i = 0; i < x.extent(0); ++i) sum += x(i) * y(i);
  return sum;
}

/// |b - A x| / |b| with the plain operator.
double relative_residual(const ElasticSystem& system, const RealView& b, const RealView& x) {
  const RealView r("cgcontact::perf::residual", b.extent(0));
  PlainOperator(system).apply(ExecSpace(), x, r);
  Kokkos::fence();
  for (std::size_t i = 0; i < b.extent(0); ++i) r(i) = b(i) - r(i);
  return std::sqrt(dot(r, r) / dot(b, b));
}

struct SolverProblem : SceneProblem {
  RealView b;
  explicit SolverProblem(int n)
      : SceneProblem("scenes/two_solids_3d.toml", {"n=" + std::to_string(n)}), b(random_vector(system.num_dofs(), 5)) {}
  RealView zero() const { return RealView("cgcontact::perf::zero", system.num_dofs()); }
};

/// What the operator moves and computes on one level, single precision: bench_operator.cpp.
Cost operator_cost(const FastOperator<float>& op) {
  const auto& s = op.sizes();
  const auto number = [](long long n) { return static_cast<double>(n); };
  const double cells = number(s.cut_cells) + number(s.full_cells);
  return {108 * number(s.stencil_nodes) + 780 * number(s.cut_cells) + 243 * number(s.full_cells) +
              156 * number(s.ghost_faces) + 96 * number(s.ghost_chains) + 4 * number(s.group_entries),
          36 * number(s.num_nodes) + 108 * number(s.cut_cells) + 24 * cells + 8 * number(s.ghost_faces) +
              32 * number(s.ghost_chains) + 16 * number(s.group_entries),
          true};
}

/// A residual (one more vector than the operator reads) and d = beta d + alpha M^-1 r, x += d: r, six numbers per node,
/// d and x in both directions, the number of the surface node; 27 flop per node. Surface rows are not counted.
Cost step_cost(const FastOperator<float>& op) {
  Cost cost = operator_cost(op);
  const double nodes = static_cast<double>(op.sizes().num_nodes);
  cost.flop += 30 * nodes;
  cost.bytes += nodes * (12 + 12 + 24 + 24 + 24 + 4);
  return cost;
}

/// The finest level's smoother.
struct Smoothing {
  SolverProblem problem;
  FastOperator<float> op;
  FastOperator<float>::BlockView blocks;
  std::unique_ptr<SurfaceSmoother<float>> smoother;
  FastOperator<float>::VectorView b, x, r, d;

  explicit Smoothing(int n) : problem(n), op(problem.system) {
    const int size = problem.system.num_dofs();
    blocks = decltype(blocks)("cgcontact::perf::blocks", problem.system.num_nodes);
    const NodeColumns<float> columns = make_node_columns<float>(problem.system);
    op.diagonal_blocks(ExecSpace(), blocks, columns);
    smoother = std::make_unique<SurfaceSmoother<float>>(problem.system, blocks, columns,
                                                        make_support_rows(problem.system, columns));
    smoother->set_groups(problem.system.group_rows, problem.system.full_group_stiffness);
    for (auto* v : {&b, &x, &r, &d}) *v = FastOperator<float>::VectorView("cgcontact::perf::vector", size);
    for (int i = 0; i < size; ++i) b(i) = static_cast<float>(problem.b(i));
  }
  void step(float alpha, float beta) {
    const ExecSpace exec;
    op.residual(exec, b, x, r);
    smoother->step(exec, r, alpha, beta, d, x, false);
  }
  /// M d against b after one step from zero with alpha = 1. M: the blocks of nodes and columns, the contact groups.
  double error() {
    step(1, 0);
    Kokkos::fence();
    const int size = problem.system.num_dofs();
    const RealView dd = problem.zero(), Md = problem.zero();
    for (int i = 0; i < size; ++i) dd(i) = d(i);
    apply_groups(ExecSpace(), problem.system.groups, dd, Md);
    const FastOperator<double> in_double(problem.system);
    const FastOperator<double>::BlockView D("cgcontact::perf::D", problem.system.num_nodes);
    const NodeColumns<double> columns = make_node_columns<double>(problem.system);
    in_double.diagonal_blocks(ExecSpace(), D, columns);
    constexpr int at[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    for (int n = 0; n < problem.system.num_nodes; ++n)
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) Md(dof_of(n, i)) += D(n, at[i][j]) * dd(dof_of(n, j));
    const SupportRows supports = make_support_rows(problem.system, columns);
    for (std::size_t g = 0; g < supports.rows.size(); ++g)
      for (const auto& [p, vp] : supports.rows[g].entries)
        for (const auto& [q, vq] : supports.rows[g].entries)
          if (p / 3 != q / 3) Md(p) += supports.stiffness[g] * vp * vq * dd(q);
    for (int c = 0; c < columns.num_columns(); ++c) {
      const auto& column = columns.columns(c);
      const int entries = dof_of(column.size);
      const auto dof = [&](int i) { return dof_of(columns.nodes(column.first + node_of_dof(i)), component_of_dof(i)); };
      for (int i = 0; i < entries; ++i)
        for (int j = 0; j < entries; ++j) Md(dof(i)) += columns.matrices(column.matrix + i * entries + j) * dd(dof(j));
    }
    for (int i = 0; i < size; ++i) Md(i) -= b(i);
    return std::sqrt(dot(Md, Md) / dot(problem.b, problem.b));
  }
};

Kernel smoother_step(int n) {
  auto s = std::make_shared<Smoothing>(n);
  Kernel k;
  k.items = s->problem.system.num_dofs();
  k.cost = step_cost(s->op);
  k.error = s->error(), k.tolerance = 1e-4, k.against = "the smoother's base M times the step";
  k.run = [s] { s->step(1e-3f, 0.5f); };
  return k;
}

struct Cycle {
  SolverProblem problem;
  RCP<const TpetraMap> map;
  Multigrid multigrid;
  TpetraVector r, z;
  explicit Cycle(int n)
      : problem(n),
        map(problem.system.dofs.vector_map(Tpetra::getDefaultComm())),
        multigrid(problem.system),
        r(map, 1),
        z(map, 1) {
    const auto host = r.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t i = 0; i < problem.b.extent(0); ++i) host(i, 0) = problem.b(i);
  }
  void run() { multigrid.apply(r, z, Teuchos::NO_TRANS, 1, 0); }
  /// Factor by which a cycle reduces the energy norm of the error, mean over some cycles from a random error.
  double reduction() {
    constexpr int cycles = 6;
    const PlainOperator plain(problem.system);
    RealView e = random_vector(problem.system.num_dofs(), 8);
    const RealView Ae = problem.zero();
    TpetraVector in(map, 1), out(map, 1);
    double first = 0, last = 0;
    for (int i = 0; i <= cycles; ++i) {
      plain.apply(ExecSpace(), e, Ae);
      Kokkos::fence();
      last = std::sqrt(dot(e, Ae));
      if (i == 0) first = last;
      {
        const auto host = in.getLocalViewHost(Tpetra::Access::OverwriteAll);
        for (std::size_t j = 0; j < e.extent(0); ++j) host(j, 0) = Ae(j);
      }
      multigrid.apply(in, out, Teuchos::NO_TRANS, 1, 0);
      const auto host = out.getLocalViewHost(Tpetra::Access::ReadOnly);
      for (std::size_t j = 0; j < e.extent(0); ++j) e(j) -= host(j, 0);
    }
    return std::pow(last / first, 1.0 / cycles);
  }
};

constexpr double expected_reduction = 0.6;

/// Per level 6 steps of the smoother, whose first knows its residual, and a residual; the coarser levels as if the
/// finest one's costs scaled with the unknowns; in and out of single precision 36 bytes per unknown. Transfers and the
/// coarsest level are not counted.
Kernel v_cycle(int n) {
  auto c = std::make_shared<Cycle>(n);
  const std::vector<int>& unknowns = c->multigrid.report().unknowns;
  double all = 0;
  for (std::size_t l = 0; l + 1 < unknowns.size(); ++l) all += static_cast<double>(unknowns[l]) / unknowns[0];
  Kernel k;
  k.items = unknowns[0];
  const Cost step = step_cost(FastOperator<float>(c->problem.system));
  k.cost = {6 * all * step.flop, 6 * all * step.bytes + 36.0 * unknowns[0], true};
  k.error = c->reduction(), k.tolerance = expected_reduction, k.against = "the error's energy norm before";
  k.run = [c] { c->run(); };
  k.figures = {{"levels", static_cast<double>(unknowns.size())}};
  return k;
}

Kernel setup(int n) {
  auto c = std::make_shared<Cycle>(n);
  Kernel k;
  k.items = c->problem.system.num_dofs();
  k.error = c->reduction(), k.tolerance = expected_reduction, k.against = "the error's energy norm before";
  k.run = [c] { Multigrid{c->problem.system}; };
  return k;
}

/// Held by the process, without what was freed before.
double trimmed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  return status_bytes("VmRSS");
}

/// Times and memory of one way to the solution.
class Way {
 public:
  double setup_s = 0, solve_s = 0, held = 0, peak = 0, before = 0;
  int iterations = 0;
  double assembly_s = 0;  ///< included in the set-up

  void start() {
    before = trimmed_memory();  // what was freed before does not hide what is taken now
    reset_peak_memory();
    last_ = now();
  }
  void lap(double& seconds) {
    Kokkos::fence();
    seconds = now() - last_;
    last_ += seconds;
  }
  void set_up() { held = status_bytes("VmRSS") - before; }
  void stop() { peak = status_bytes("VmHWM") - before; }
  void keep_faster(const Way& other) {
    if (iterations == 0 || other.setup_s + other.solve_s < setup_s + solve_s) *this = other;
  }

 private:
  double last_ = 0;
};

void solve_with_multigrid(const ElasticSystem& system, const RealView& b, const RealView& x, Way& way) {
  Kokkos::deep_copy(x, 0.0);
  way.start();
  LinearSolver solver(ExecSpace(), system, Preconditioner::multigrid);
  solver.update();
  way.lap(way.setup_s);
  way.set_up();
  way.iterations = solver.solve(b, x, tolerance * std::sqrt(dot(b, b)), max_iterations).iterations;
  way.lap(way.solve_s);
  way.stop();
}

void solve_with_muelu(const SolverProblem& p, const RealView& x, Way& way) {
  way.start();
  const RCP<const TpetraMap> map = p.system.dofs.vector_map(Tpetra::getDefaultComm());
  const RCP<TpetraMatrix> matrix = assemble_matrix(p.system, map);
  way.lap(way.assembly_s);
  const RCP<TpetraOperator> muelu = make_muelu(p.system, map, matrix);
  way.lap(way.setup_s);
  way.setup_s += way.assembly_s;
  way.set_up();
  const auto rhs = rcp(new TpetraVector(map, 1)), solution = rcp(new TpetraVector(map, 1));
  {
    const auto host = rhs->getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t i = 0; i < p.b.extent(0); ++i) host(i, 0) = p.b(i);
  }
  way.iterations =
      solve_krylov(LinearMethod::flexible_cg, matrix, muelu, rhs, solution, 0.95 * tolerance, max_iterations);
  way.lap(way.solve_s);
  way.stop();
  const auto host = solution->getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t i = 0; i < x.extent(0); ++i) x(i) = host(i, 0);
}

struct Comparison {
  SolverProblem problem;
  RealView x, x_muelu;
  Way multigrid, muelu;
  explicit Comparison(int n) : problem(n), x(problem.zero()), x_muelu(problem.zero()) {}
};

Kernel solve(int n) {
  auto c = std::make_shared<Comparison>(n);
  Kernel k;
  k.items = c->problem.system.num_dofs();
  k.tolerance = 1.01 * tolerance, k.against = "the plain operator times the solution";
  k.run = [c] {
    Way way;
    solve_with_multigrid(c->problem.system, c->problem.b, c->x, way);
    c->multigrid.keep_faster(way);
  };
  k.baseline = [c] {
    Way way;
    solve_with_muelu(c->problem, c->x_muelu, way);
    c->muelu.keep_faster(way);
  };
  k.ratio = "times_muelu";
  k.finish = [c](Kernel& kernel) {
    const ElasticSystem& system = c->problem.system;
    kernel.error =
        std::max(relative_residual(system, c->problem.b, c->x), relative_residual(system, c->problem.b, c->x_muelu));
    const double size = kernel.items;
    const Way &ours = c->multigrid, &theirs = c->muelu;
    kernel.figures = {{"iterations", static_cast<double>(ours.iterations)},
                      {"setup_s", ours.setup_s},
                      {"solve_s", ours.solve_s},
                      {"before_B/DoF", ours.before / size},
                      {"set_up_B/DoF", ours.held / size},
                      {"B/DoF", ours.peak / size},
                      {"muelu_iterations", static_cast<double>(theirs.iterations)},
                      {"muelu_assembly_s", theirs.assembly_s},
                      {"muelu_setup_s", theirs.setup_s},
                      {"muelu_solve_s", theirs.solve_s},
                      {"muelu_DoF/s", size / (theirs.setup_s + theirs.solve_s)},
                      {"muelu_set_up_B/DoF", theirs.held / size},
                      {"muelu_B/DoF", theirs.peak / size}};
  };
  return k;
}

constexpr int tree_levels = 6;

/// The block, a random force on its unknowns, and the way to the solution.
struct HeldBlock {
  double before;  ///< memory before the block is made
  BlockProblem problem;
  double system_bytes;
  RealView b, x;
  Way way;
  HeldBlock(int size, int levels) : before(trimmed_memory()), problem(size, levels) {
    problem.hold_lower_face();
    system_bytes = trimmed_memory() - before;
    b = random_vector(problem.system.num_dofs(), 5);
    for (const NodeConstraint& c : problem.system.constraints)
      for (int i = 0; i < dofs_per_node; ++i) b(dof_of(c.node, i)) = 0;
    x = RealView("cgcontact::perf::x", b.extent(0));
  }
  void solve() {
    Way next;
    solve_with_multigrid(problem.system, b, x, next);
    way.keep_faster(next);
  }
  double error() const { return relative_residual(problem.system, b, x); }
};

Kernel tree(int n) {
  auto tree = std::make_shared<HeldBlock>(n, tree_levels), uniform = std::make_shared<HeldBlock>(n, 1);
  Kernel k;
  k.items = tree->problem.system.num_free_dofs();
  k.baseline_items = uniform->problem.system.num_free_dofs();
  k.tolerance = 1.01 * tolerance, k.against = "the plain operator times the solution";
  k.run = [tree] { tree->solve(); };
  k.baseline = [uniform] { uniform->solve(); };
  k.ratio = "of_uniform";
  k.finish = [tree, uniform](Kernel& kernel) {
    kernel.error = std::max(tree->error(), uniform->error());
    const double size = kernel.items, uniform_size = kernel.baseline_items;
    const Way &ours = tree->way, &theirs = uniform->way;
    kernel.figures = {{"iterations", static_cast<double>(ours.iterations)},
                      {"setup_s", ours.setup_s},
                      {"solve_s", ours.solve_s},
                      {"setup_of_uniform", theirs.setup_s / uniform_size / (ours.setup_s / size)},
                      {"solve_of_uniform", theirs.solve_s / uniform_size / (ours.solve_s / size)},
                      {"system_B/DoF", tree->system_bytes / size},
                      {"set_up_B/DoF", ours.held / size},
                      {"B/DoF", ours.peak / size},
                      {"uniform_DoF", uniform_size},
                      {"uniform_iterations", static_cast<double>(theirs.iterations)},
                      {"uniform_setup_s", theirs.setup_s},
                      {"uniform_solve_s", theirs.solve_s},
                      {"uniform_system_B/DoF", uniform->system_bytes / uniform_size},
                      {"uniform_set_up_B/DoF", theirs.held / uniform_size},
                      {"uniform_B/DoF", theirs.peak / uniform_size}};
  };
  return k;
}

}  // namespace

int main(int argc, char** argv) {
  return run_benchmarks(argc, argv, [] {
    add("multigrid/smoother_step", smoother_step, {{5}, {26, 56}});
    add("multigrid/v_cycle", v_cycle, {{5}, {26, 56}});
    add("multigrid/setup", setup, {{5}, {26, 56}});
    add("solver/solve", solve, {{5}, {26, 56}});
    add("solver/tree", tree, {{6}, {32, 68}});
  });
}
