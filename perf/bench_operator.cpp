/// Operator application: matrix-free kernels against Tpetra's CrsMatrix on the same system (a block on a shifted grid).
/// The result is verified before it is timed. Cost model: 2 x 24 x 24 flop per cell; reported as DoF/s.
#include <benchmark/benchmark.h>

#include <Tpetra_Core.hpp>
#include <map>
#include <memory>

#include "core/resources.hpp"
#include "kernels/assembly.hpp"
#include "kernels/linear_solver.hpp"

namespace {

using namespace cgcontact;

/// A block of n cells along each edge on a grid shifted by irrational fractions, with its operator and its matrix.
struct Problem {
  CutCells cut_cells;
  ElasticSystem system;
  Teuchos::RCP<const TpetraMap> map;
  Teuchos::RCP<ElasticityOperator> op;
  Teuchos::RCP<TpetraMatrix> matrix;

  explicit Problem(int n) {
    Grid grid;
    grid.num_cells = {n + 1, n + 1, n + 1};
    const Vec3 start(0.414, 0.732, 0.236);
    cut_cells = make_cut_cells(Solid::box(start, start + Vec3::Constant(n), "block"), grid);
    system = make_elastic_system({&cut_cells}, {Material{1, 0.3}}, Scales{1, 1}, 0.01);
    map = make_dof_map(system, Tpetra::getDefaultComm());
    op = Teuchos::rcp(new ElasticityOperator(system, map));
    matrix = assemble_matrix(system, map);
  }
};

/// One problem per size, shared by the benchmarks; cleared before Kokkos ends.
std::map<int, std::unique_ptr<Problem>> problems;

const Problem& problem(int n) {
  auto& p = problems[n];
  if (!p) p = std::make_unique<Problem>(n);
  return *p;
}

double relative_difference(const Problem& p) {
  TpetraVector x(p.map, 1), y(p.map, 1), z(p.map, 1);
  x.randomize();
  p.op->apply(x, y, Teuchos::NO_TRANS, 1, 0);
  p.matrix->apply(x, z, Teuchos::NO_TRANS, 1, 0);
  const double scale = z.getVector(0)->norm2();
  z.update(-1, y, 1);
  return z.getVector(0)->norm2() / scale;
}

void time_apply(benchmark::State& state, const Problem& p, const TpetraOperator& op) {
  if (relative_difference(p) > 1e-12) state.SkipWithError("operator and matrix differ");
  TpetraVector x(p.map, 1), y(p.map, 1);
  x.randomize();
  for (auto _ : state) {
    op.apply(x, y, Teuchos::NO_TRANS, 1, 0);
    Kokkos::fence();
  }
  state.counters["DoF/s"] =
      benchmark::Counter(static_cast<double>(p.system.num_dofs()) * state.iterations(), benchmark::Counter::kIsRate);
  state.counters["DoF"] = p.system.num_dofs();
  state.counters["cut"] = static_cast<double>(p.cut_cells.moments.size()) / p.cut_cells.cells.size();
}

void matrix_free(benchmark::State& state) {
  const Problem& p = problem(static_cast<int>(state.range(0)));
  time_apply(state, p, *p.op);
}

void crs_matrix(benchmark::State& state) {
  const Problem& p = problem(static_cast<int>(state.range(0)));
  time_apply(state, p, *p.matrix);
}

BENCHMARK(matrix_free)->Arg(6)->Arg(20)->Arg(50)->Unit(benchmark::kMillisecond);
BENCHMARK(crs_matrix)->Arg(6)->Arg(20)->Arg(50)->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
  if (cgcontact::TrilinosScope::has_openmp()) cgcontact::restart_with_openmp_settings(0, argv);
  benchmark::Initialize(&argc, argv);
  const cgcontact::TrilinosScope trilinos(0);
  benchmark::RunSpecifiedBenchmarks();
  problems.clear();
  return 0;
}
