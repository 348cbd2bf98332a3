/// Common frame of the microbenchmarks: a kernel says what one call costs and how far its result is off; the frame
/// refuses wrong results, times the calls, and reports rates beside the machine's limits measured in the same program.
///
///   Kernel make_dot(int n) {                      // builds the problem, runs once, compares with the plain reference
///     ...
///     Kernel k;
///     k.unit = "DoF", k.items = n;
///     k.cost = {2.0 * n, 16.0 * n};               // x . y: one multiply-add per entry; reads x and y
///     k.error = std::abs(dot(x, y) - plain) / plain, k.tolerance = 1e-13, k.against = "plain loop";
///     k.run = [=] { dot(x, y); };
///     return k;
///   }
///   int main(int argc, char** argv) {
///     return perf::run_benchmarks(argc, argv, [] { perf::add("vectors/dot", make_dot, {{1000}, {100000}}); });
///   }
///
/// docs/performance.md says how to run them and how to read the figures.
#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "kernels/mesh/views.hpp"
#include "perf/machine_limits.hpp"

namespace cgcontact::perf {

/// Work of one call, from a model written next to the kernel: floating-point operations, and bytes that have to move
/// between memory and processor if every datum moves once. A result that is only written counts twice (write-allocate).
struct Cost {
  double flop = 0;
  double bytes = 0;
  bool single = false;  ///< single precision: twice as many lanes, so twice the multiply-add peak
};

struct Kernel {
  std::string unit = "DoF";  ///< what `items` counts: DoF, cells, patches, ...
  double items = 0;          ///< per call
  Cost cost;                 ///< per call; 0: no model, that rate is not reported
  /// Verification of one call made before the timing: error against `against`; above the tolerance nothing is timed.
  double error = 0, tolerance = 0;
  std::string against;
  std::function<void()> run;
  /// The straightforward alternative, timed in turns with `run`: the ratio of the times is reported. Optional.
  std::function<void()> baseline;
  std::string ratio = "speedup";  ///< what it is called
  double baseline_items = 0;      ///< per call of the baseline; 0: as many. The ratio is that of the times per item
  /// Long runs, of seconds and more: no warm-up. Called after the timing; verifies the last run (error) and adds to the
  /// figures. Optional.
  std::function<void(Kernel&)> finish;
  std::vector<std::pair<std::string, double>> figures;  ///< further figures of the problem (share of cut cells, ...)
};

/// Sizes of a benchmark: for tests (--toy) and for measurements. --sizes=A,B or CGCONTACT_PERF_SIZES replace the
/// latter.
struct Sizes {
  std::vector<int> toy, full;
};

/// Registers the benchmark `name`/SIZE for every size. `make` is called when its turn comes; what it returns is
/// destroyed when the next one's has come.
void add(const std::string& name, std::function<Kernel(int size)> make, const Sizes& sizes);

/// Verifies and times inside any Google Benchmark (add() uses it). The rates are those of the fastest sample, a sample
/// being enough calls to last 50 us by the clock now(); the times Google Benchmark prints are means.
void measure(benchmark::State& state, const Kernel& kernel);

/// Stops a benchmark with an error and makes the program fail.
void fail(benchmark::State& state, const std::string& message);

bool is_toy();
const MachineLimits& machine_limits();

/// Starts Kokkos and Trilinos, measures the machine, runs what `register_all` registers (and BENCHMARK macros); the
/// exit code of the program: 0 if all results were right. Arguments: --toy, --sizes=, --threads= and Google
/// Benchmark's.
int run_benchmarks(int argc, char** argv, const std::function<void()>& register_all);

/// |x - y| / |y| in the largest entry.
double relative_difference(const RealView& x, const RealView& y);

}  // namespace cgcontact::perf
