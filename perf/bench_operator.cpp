/// Operator application, the fast one with its parts, the plain kernels and Tpetra's CrsMatrix on the same system.
///   block: cells of a box on a shifted grid; cube: no cell cut; ball: about 20 % of the cells cut at 46 cells across.
/// Every operator is verified against the plain kernels before it is timed (cubes: up to 60 cells along an edge).
#include <benchmark/benchmark.h>

#include <Tpetra_Core.hpp>
#include <chrono>
#include <ctime>
#include <map>
#include <memory>

#include "core/resources.hpp"
#include "kernels/assembly.hpp"
#include "kernels/fast_operator.hpp"
#include "kernels/linear_solver.hpp"

namespace {

using namespace cgcontact;

enum Shape { block, cube, ball };

/// A cube of full cells (make_cut_cells would call those at the faces cut).
CutCells whole_cells(int n) {
  CutCells cc;
  cc.grid.num_cells = {n, n, n};
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        cc.active_of_cell.push_back(static_cast<int>(cc.cells.size()));
        cc.cells.push_back({i, j, k});
      }
  cc.cut_of_active.assign(cc.cells.size(), -1);
  return cc;
}

struct Problem {
  CutCells cut_cells;
  ElasticSystem system;
  std::map<bool, std::shared_ptr<void>> fast;  ///< FastOperator<double>, <float>
  Teuchos::RCP<const TpetraMap> map;
  Teuchos::RCP<TpetraMatrix> matrix;

  Problem(Shape shape, int n, bool reference) {
    Grid grid;
    grid.num_cells = {n + 1, n + 1, n + 1};
    const Vec3 start(0.414, 0.732, 0.236);
    if (shape == block)
      cut_cells = make_cut_cells(Solid::box(start, start + Vec3::Constant(n), "block"), grid);
    else if (shape == cube)
      cut_cells = whole_cells(n);
    else
      cut_cells = make_cut_cells(Solid::sphere(start + Vec3::Constant(0.5 * n), 0.5 * n, "ball"), grid);
    system = make_elastic_system({&cut_cells}, {Material{1, 0.3}}, Scales{1, 1}, 0.01);
    std::vector<GroupRow> rows;  // block: groups of 24 DoFs, as many as a face has cells
    for (int g = 0; shape == block && g < n * n && 24 * (g + 1) < system.num_dofs(); ++g) {
      rows.emplace_back();
      for (int e = 0; e < 24; ++e) rows.back().entries.emplace_back(system.num_dofs() - 24 * (g + 1) + e, 0.1);
    }
    set_group_rows(system, rows);
    set_group_stiffness(system, std::vector<double>(rows.size(), 0.5));
    if (!reference) return;
    map = make_dof_map(system, Tpetra::getDefaultComm());
    matrix = assemble_matrix(system, map);
  }

  template <class Real>
  const FastOperator<Real>& fast_operator() {
    auto& f = fast[sizeof(Real) == 8];
    if (!f) f = std::make_shared<FastOperator<Real>>(system);
    return *static_cast<FastOperator<Real>*>(f.get());
  }
};

/// Shared by the benchmarks; cleared before Kokkos ends.
std::map<std::pair<int, int>, std::unique_ptr<Problem>> problems;

Problem& problem(benchmark::State& state) {
  auto& p = problems[{state.range(0), state.range(1)}];
  const auto n = static_cast<int>(state.range(1));
  if (!p) p = std::make_unique<Problem>(static_cast<Shape>(state.range(0)), n, n <= 50);
  return *p;
}

template <class Real>
Kokkos::View<Real*, MemSpace> random_vector(int size) {
  Kokkos::View<Real*, MemSpace> x("x", size);
  std::uint64_t s = 1;
  for (int i = 0; i < size; ++i) {
    s = s * 6364136223846793005ull + 1442695040888963407ull;
    x(i) = static_cast<Real>(static_cast<float>(static_cast<double>(s >> 40) / (1 << 24) - 0.5));
  }
  return x;
}

/// Times apply(x, y) once its result has been compared with the plain kernels.
template <class Real, class Apply>
void time_apply(benchmark::State& state, const Problem& p, bool verify, const Apply& apply) {
  const int n = p.system.num_dofs();
  const auto x = random_vector<Real>(n);
  Kokkos::View<Real*, MemSpace> y("y", n);
  if (verify && n < 1000000) {
    const RealView xd = random_vector<double>(n), yd("yd", n);
    p.system.apply(ExecSpace(), xd, yd);
    apply(x, y);
    double error = 0, scale = 0;
    for (int i = 0; i < n; ++i) {
      error = std::max(error, std::abs(y(i) - yd(i)));
      scale = std::max(scale, std::abs(yd(i)));
    }
    if (!(error < (sizeof(Real) == 8 ? 1e-12 : 1e-5) * scale)) state.SkipWithError("differs from the plain kernels");
  }
  double best = 1e300, best_cpu = 1e300;  // on a machine with other work the fastest iteration says most
  auto cpu_time = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    const double cpu_start = cpu_time();
    apply(x, y);
    Kokkos::fence();
    best_cpu = std::min(best_cpu, cpu_time() - cpu_start);
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  state.counters["best_cpu_us"] = 1e6 * best_cpu;  // of all threads
  state.counters["best_us"] = 1e6 * best;
  state.counters["best_MDoF/s"] = 1e-6 * n / best;
  state.counters["DoF/s"] =
      benchmark::Counter(static_cast<double>(n) * state.iterations(), benchmark::Counter::kIsRate);
  state.counters["DoF"] = n;
  state.counters["cut"] = static_cast<double>(p.cut_cells.moments.size()) / p.cut_cells.cells.size();
}

enum Part { all, interior, cut, ghost, contact, residual };

template <class Real, int part>
void fast(benchmark::State& state) {
  Problem& p = problem(state);
  const FastOperator<Real>& A = p.fast_operator<Real>();
  const auto b = random_vector<Real>(p.system.num_dofs());
  time_apply<Real>(state, p, part == all, [&](const auto& x, const auto& y) {
    const ExecSpace exec;
    if (part == all) A.apply(exec, x, y);
    if (part == interior) A.apply_stencil(exec, x, y);
    if (part == cut) A.add_band(exec, x, y, true, false);
    if (part == ghost) A.add_band(exec, x, y, false, true);
    if (part == contact) A.add_groups(exec, x, y);
    if (part == residual) A.residual(exec, b, x, y);
  });
  state.counters["bytes/DoF"] = static_cast<double>(A.sizes().bytes) / A.num_dofs();
}

/// Construction from the system.
template <class Real>
void setup(benchmark::State& state) {
  Problem& p = problem(state);
  for (auto _ : state) benchmark::DoNotOptimize(FastOperator<Real>(p.system).num_dofs());
  state.counters["DoF/s"] =
      benchmark::Counter(static_cast<double>(p.system.num_dofs()) * state.iterations(), benchmark::Counter::kIsRate);
}

void plain(benchmark::State& state) {
  const Problem& p = problem(state);
  time_apply<double>(state, p, false, [&](const auto& x, const auto& y) { p.system.apply(ExecSpace(), x, y); });
}

void crs_matrix(benchmark::State& state) {
  const Problem& p = problem(state);
  TpetraVector x(p.map, 1), y(p.map, 1);
  x.randomize();
  time_apply<double>(state, p, false, [&](const auto&, const auto&) { p.matrix->apply(x, y); });
}

void sizes(benchmark::internal::Benchmark* b) {
  b->Args({block, 6})->Args({cube, 6})->Args({ball, 6});
  b->Args({ball, 46})->Args({block, 50})->Args({cube, 36})->Args({cube, 118});
  b->Unit(benchmark::kMillisecond);
}
void small_sizes(benchmark::internal::Benchmark* b) {
  b->Args({block, 6})->Args({ball, 46})->Args({block, 50})->Unit(benchmark::kMillisecond);
}

BENCHMARK_TEMPLATE(fast, double, all)->Apply(sizes);
BENCHMARK_TEMPLATE(fast, double, residual)->Apply(sizes);
BENCHMARK_TEMPLATE(fast, double, interior)->Apply(sizes);
BENCHMARK_TEMPLATE(fast, double, cut)->Apply(sizes);
BENCHMARK_TEMPLATE(fast, double, ghost)->Apply(small_sizes);
BENCHMARK_TEMPLATE(fast, double, contact)->Apply(small_sizes);
BENCHMARK_TEMPLATE(fast, float, all)->Apply(sizes);
BENCHMARK_TEMPLATE(fast, float, interior)->Apply(sizes);
BENCHMARK_TEMPLATE(fast, float, cut)->Apply(sizes);
BENCHMARK_TEMPLATE(fast, float, ghost)->Apply(small_sizes);
BENCHMARK_TEMPLATE(setup, double)->Apply(sizes);
BENCHMARK(plain)->Apply(small_sizes);
BENCHMARK(crs_matrix)->Apply(small_sizes);

}  // namespace

int main(int argc, char** argv) {
  if (cgcontact::TrilinosScope::has_openmp()) cgcontact::restart_with_openmp_settings(0, argv);
  benchmark::Initialize(&argc, argv);
  const cgcontact::TrilinosScope trilinos(0);
  benchmark::RunSpecifiedBenchmarks();
  problems.clear();
  return 0;
}
