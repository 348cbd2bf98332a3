/// A tool for Kokkos' profiling interface: prints how the wall time of a program divides into labelled kernels and
/// labelled regions, at its end, to standard error.
///
///   KOKKOS_PROFILE_LIBRARY=build/serial/perf/libkernel_timer.so build/serial/cgcontact run SCENE (KOKKOS_TOOLS_LIBS
///   from Kokkos 4 on)
///
/// Kernels are what the starting thread dispatches or copies (parallel_for, parallel_reduce, parallel_scan, deep_copy);
/// one inside another counts for the outer one. Regions are those that are not inside another; "in kernels" is the time
/// that kernels take of theirs.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

struct Sum {
  long long calls = 0;
  double seconds = 0, in_kernels = 0;
};

/// Everything is kept for the thread that starts Kokkos; other threads' calls belong to its kernels.
struct Timer {
  std::thread::id thread;
  double start = 0, kernel_start = 0, region_start = 0, kernels_before_region = 0, in_kernels = 0;
  int kernel_depth = 0, region_depth = 0;
  std::string kernel, region;
  std::map<std::string, Sum> kernels, regions;

  bool listens() const { return std::this_thread::get_id() == thread; }
  void begin_kernel(const std::string& name) {
    if (!listens() || kernel_depth++ > 0) return;
    kernel = name.substr(0, name.find(" ["));  // "Kokkos::View::initialization [label of the view]"
    kernel_start = now();
  }
  void end_kernel() {
    if (!listens() || --kernel_depth > 0) return;
    const double seconds = now() - kernel_start;
    Sum& sum = kernels[kernel];
    ++sum.calls;
    sum.seconds += seconds;
    in_kernels += seconds;
  }
  void begin_region(const std::string& name) {
    if (!listens() || region_depth++ > 0) return;
    region = name;
    region_start = now();
    kernels_before_region = in_kernels;
  }
  void end_region() {
    if (!listens() || --region_depth > 0) return;
    Sum& sum = regions[region];
    ++sum.calls;
    sum.seconds += now() - region_start;
    sum.in_kernels += in_kernels - kernels_before_region;
  }
};

Timer timer;

std::vector<std::pair<std::string, Sum>> longest_first(const std::map<std::string, Sum>& sums) {
  std::vector<std::pair<std::string, Sum>> sorted(sums.begin(), sums.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.second.seconds > b.second.seconds; });
  return sorted;
}

void print() {
  const double whole = now() - timer.start;
  double in_regions = 0;
  for (const auto& [name, sum] : timer.regions) in_regions += sum.seconds;
  std::fprintf(stderr, "\n%-60s %9s %10s %7s\n", "kernel", "calls", "seconds", "share");
  for (const auto& [name, sum] : longest_first(timer.kernels))
    std::fprintf(stderr, "%-60s %9lld %10.4f %6.1f%%\n", name.c_str(), sum.calls, sum.seconds,
                 100 * sum.seconds / whole);
  std::fprintf(stderr, "\n%-60s %9s %10s %7s %11s\n", "region", "calls", "seconds", "share", "in kernels");
  for (const auto& [name, sum] : longest_first(timer.regions))
    std::fprintf(stderr, "%-60s %9lld %10.4f %6.1f%% %10.1f%%\n", name.c_str(), sum.calls, sum.seconds,
                 100 * sum.seconds / whole, 100 * sum.in_kernels / sum.seconds);
  std::fprintf(stderr, "\nfrom start to end %.3f s: %.1f%% in kernels, %.1f%% in regions\n", whole,
               100 * timer.in_kernels / whole, 100 * in_regions / whole);
}

}  // namespace

extern "C" {

void kokkosp_init_library(int, std::uint64_t, std::uint32_t, void*) {
  timer.thread = std::this_thread::get_id();
  timer.start = now();
}
void kokkosp_finalize_library() { print(); }

void kokkosp_begin_parallel_for(const char* name, std::uint32_t, std::uint64_t*) { timer.begin_kernel(name); }
void kokkosp_begin_parallel_reduce(const char* name, std::uint32_t, std::uint64_t*) { timer.begin_kernel(name); }
void kokkosp_begin_parallel_scan(const char* name, std::uint32_t, std::uint64_t*) { timer.begin_kernel(name); }
void kokkosp_end_parallel_for(std::uint64_t) { timer.end_kernel(); }
void kokkosp_end_parallel_reduce(std::uint64_t) { timer.end_kernel(); }
void kokkosp_end_parallel_scan(std::uint64_t) { timer.end_kernel(); }

/// The space's name, as Kokkos passes it: 64 characters.
struct SpaceHandle {
  char name[64];
};
void kokkosp_begin_deep_copy(SpaceHandle, const char*, const void*, SpaceHandle, const char*, const void*,
                             std::uint64_t) {
  timer.begin_kernel("Kokkos::deep_copy");
}
void kokkosp_end_deep_copy() { timer.end_kernel(); }

void kokkosp_push_profile_region(const char* name) { timer.begin_region(name); }
void kokkosp_pop_profile_region() { timer.end_region(); }
}
