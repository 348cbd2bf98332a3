#include "perf/harness.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "core/base/process/resources.hpp"
#include "kernels/solver/linear_solver.hpp"

namespace cgcontact::perf {
namespace {

struct Frame {
  bool toy = false;
  int threads = 0;
  std::vector<int> sizes;  ///< empty: each benchmark's own
  MachineLimits limits;
  bool failed = false;
  /// Google Benchmark calls a benchmark several times to find the number of iterations; the problem is built once.
  std::string current;
  std::unique_ptr<Kernel> kernel;
};

Frame& frame() {
  static Frame instance;
  return instance;
}

std::vector<int> read_sizes(const std::string& text) {
  std::vector<int> sizes;
  std::istringstream fields(text);
  for (std::string field; std::getline(fields, field, ',');) {
    std::size_t used = 0;
    int size = 0;
    try {
      size = std::stoi(field, &used);
    } catch (const std::exception&) {
    }
    if (size < 1 || used != field.size()) throw std::invalid_argument("sizes are positive numbers: " + text);
    sizes.push_back(size);
  }
  return sizes;
}

/// Takes our own arguments out of argv, leaves the rest to Google Benchmark.
void read_arguments(std::vector<std::string>& arguments) {
  Frame& f = frame();
  if (const char* sizes = std::getenv("CGCONTACT_PERF_SIZES")) f.sizes = read_sizes(sizes);
  std::vector<std::string> rest;
  for (const std::string& a : arguments) {
    if (a == "--toy")
      f.toy = true;
    else if (a.rfind("--sizes=", 0) == 0)
      f.sizes = read_sizes(a.substr(8));
    else if (a.rfind("--threads=", 0) == 0)
      f.threads = read_sizes(a.substr(10)).at(0);
    else
      rest.push_back(a);
  }
  if (f.toy) rest.insert(rest.begin() + 1, "--benchmark_min_time=0.001");
  arguments = rest;
}

/// Bound of the time that a baseline takes beside its kernel, s: plain sums may be hundreds of times slower.
constexpr double max_baseline_seconds = 1;

double seconds_of(int calls, const std::function<void()>& run) {
  const double start = now();
  for (int i = 0; i < calls; ++i) run();
  Kokkos::fence();
  return now() - start;
}

int calls_per_sample(const Kernel& kernel, const std::function<void()>& run) {
  if (kernel.finish) return 1;
  constexpr double sample = 50e-6;
  const double once = seconds_of(1, run);  // warms up as well
  return static_cast<int>(std::clamp(std::ceil(sample / std::max(once, 1e-9)), 1.0, 1e5));
}

bool is_right(benchmark::State& state, const Kernel& kernel) {
  if (kernel.error <= kernel.tolerance) return true;
  std::ostringstream message;
  message << "wrong result: off by " << kernel.error << " against " << kernel.against << " (allowed "
          << kernel.tolerance << ")";
  fail(state, message.str());
  return false;
}

void report(benchmark::State& state, const Kernel& kernel, double seconds, double baseline_seconds) {
  const MachineLimits& limits = machine_limits();
  const auto set = [&](const std::string& name, double value) {
    if (!std::isfinite(value)) return fail(state, name + " is not finite");
    state.counters[name] = value;
  };
  set(kernel.unit + "/s", kernel.items / seconds);
  set(kernel.unit, kernel.items);
  set("best_s", seconds);
  if (kernel.cost.flop > 0) {
    set("GFLOP/s", 1e-9 * kernel.cost.flop / seconds);
    set("FMA%", 100 * kernel.cost.flop / seconds / (limits.fma * (kernel.cost.single ? 2 : 1)));
  }
  if (kernel.cost.bytes > 0) {
    set("GB/s", 1e-9 * kernel.cost.bytes / seconds);
    set("triad%", 100 * kernel.cost.bytes / seconds / limits.triad);
  }
  if (kernel.cost.flop > 0 && kernel.cost.bytes > 0) set("flop/byte", kernel.cost.flop / kernel.cost.bytes);
  const double items_of_one = kernel.baseline_items > 0 ? kernel.items / kernel.baseline_items : 1;
  if (kernel.baseline) set(kernel.ratio, baseline_seconds / seconds * items_of_one);
  if (kernel.cost.single) set("single", 1);
  set("error", kernel.error);
  for (const auto& [name, value] : kernel.figures) set(name, value);
}

}  // namespace

bool is_toy() { return frame().toy; }
const MachineLimits& machine_limits() { return frame().limits; }

void fail(benchmark::State& state, const std::string& message) {
  frame().failed = true;
  state.SkipWithError(message.c_str());
}

void measure(benchmark::State& state, const Kernel& kernel) {
  if (!kernel.finish && !is_right(state, kernel)) return;
  const int calls = calls_per_sample(kernel, kernel.run);
  const int baseline_calls = kernel.baseline ? calls_per_sample(kernel, kernel.baseline) : 0;
  double best = 1e300, baseline_best = 1e300, baseline_total = 0;
  // After the baseline the kernel finds other data in the caches: it takes the best of some samples in a row.
  const int samples = kernel.baseline && !kernel.finish ? 3 : 1;
  while (state.KeepRunningBatch(calls)) {
    double seconds = 1e300;
    for (int i = 0; i < samples; ++i) seconds = std::min(seconds, seconds_of(calls, kernel.run));
    state.SetIterationTime(seconds);
    best = std::min(best, seconds / calls);
    if (kernel.baseline && baseline_total < max_baseline_seconds) {
      const double spent = seconds_of(baseline_calls, kernel.baseline);
      baseline_total += spent;
      baseline_best = std::min(baseline_best, spent / baseline_calls);
    }
  }
  if (!kernel.finish) return report(state, kernel, best, baseline_best);
  Kernel finished = kernel;
  kernel.finish(finished);
  if (is_right(state, finished)) report(state, finished, best, baseline_best);
}

void add(const std::string& name, std::function<Kernel(int size)> make, const Sizes& sizes) {
  const Frame& f = frame();
  auto* b = benchmark::RegisterBenchmark(name.c_str(), [name, make](benchmark::State& state) {
    try {
      Frame& g = frame();
      const std::string wanted = name + "/" + std::to_string(state.range(0));
      if (g.current != wanted) {
        g.kernel.reset();
        g.current.clear();
        g.kernel = std::make_unique<Kernel>(make(static_cast<int>(state.range(0))));
        g.current = wanted;
      }
      measure(state, *g.kernel);
    } catch (const std::exception& error) {
      fail(state, error.what());
    }
  });
  b->UseManualTime()->Unit(benchmark::kMicrosecond);
  for (int size : f.toy ? sizes.toy : f.sizes.empty() ? sizes.full : f.sizes) b->Arg(size);
}

int run_benchmarks(int argc, char** argv, const std::function<void()>& register_all) {
  try {
    std::vector<std::string> arguments(argv, argv + argc);
    read_arguments(arguments);
    std::vector<char*> rest;
    for (std::string& a : arguments) rest.push_back(a.data());
    int count = static_cast<int>(rest.size());
    rest.push_back(nullptr);
    benchmark::Initialize(&count, rest.data());
    if (benchmark::ReportUnrecognizedArguments(count, rest.data())) return 1;
    if (!frame().toy && TrilinosScope::has_openmp()) restart_with_openmp_settings(frame().threads, argv);
    const TrilinosScope trilinos(frame().threads);
    MachineLimits& limits = frame().limits;
    limits = measure_machine(frame().toy);
    const auto context = [](const std::string& key, double value) {
      std::ostringstream text;
      text << value;
      benchmark::AddCustomContext(key, text.str());
    };
    benchmark::AddCustomContext("backend", TrilinosScope::backend());
    context("threads", limits.threads);
    context("triad_GB/s", 1e-9 * limits.triad);
    context("triad_streaming_GB/s", 1e-9 * limits.triad_streaming);
    context("fma_GFLOP/s", 1e-9 * limits.fma);
    context("fma_lanes", FmaChains::lanes());
    register_all();
    const std::size_t count_run = benchmark::RunSpecifiedBenchmarks();
    frame().kernel.reset();  // before Kokkos ends
    if (count_run == 0) {
      std::fprintf(stderr, "no benchmark of that name\n");
      return 1;
    }
    return frame().failed ? 1 : 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
}

double relative_difference(const RealView& x, const RealView& y) {
  if (x.extent(0) != y.extent(0)) throw std::logic_error("vectors of different length");
  double difference = 0, scale = 0;
  for (std::size_t i = 0; i < x.extent(0); ++i) {
    difference = std::max(difference, std::abs(x(i) - y(i)));
    scale = std::max(scale, std::abs(y(i)));
  }
  return difference / scale;
}

}  // namespace cgcontact::perf
