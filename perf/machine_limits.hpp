/// What this machine can do at best on the threads in use: memory bandwidth and floating-point rate, the two ceilings
/// of the roofline. Both kernels check their own result.
#pragma once

#include <cstddef>

#include "kernels/mesh/views.hpp"

namespace cgcontact::perf {

/// a = b + s c on three long vectors, each thread on its own chunk.
/// Plain stores: the processor reads a's cache lines before it overwrites them (write-allocate), 32 bytes per entry
/// move and are counted. Streaming stores bypass the cache: 24 bytes per entry move and are counted.
class Triad {
 public:
  explicit Triad(std::size_t size);
  void run(bool streaming) const;
  /// Largest deviation from the exact values, which are integers: 0 if all is well.
  double error() const;
  double bytes(bool streaming) const { return (streaming ? 24.0 : 32.0) * static_cast<double>(size_); }
  double flop() const { return 2.0 * static_cast<double>(size_); }
  static bool has_streaming_stores();

 private:
  std::size_t size_;
  RealView a_, b_, c_;
};

/// Chains of fused multiply-adds in registers, as wide as the compiler's target has them, enough of them in flight to
/// hide their latency.
class FmaChains {
 public:
  FmaChains();
  void run() const;
  double error() const;
  double flop() const;
  static int lanes();  ///< doubles per register

 private:
  Kokkos::View<double**, Kokkos::LayoutRight, MemSpace> sums_;  ///< (thread, chain and lane)
};

/// A clock for durations, s. On one thread the CPU time of the calling thread, so that other programs on a busy machine
/// count as little as possible; on several threads the wall clock.
double now();

struct MachineLimits {
  int threads = 1;
  double triad = 0;            ///< bytes/s, plain stores, write-allocate counted: the ceiling the shares refer to
  double triad_streaming = 0;  ///< bytes/s, streaming stores
  double fma = 0;              ///< flop/s
};

/// Best of several runs (about 0.5 s; `toy`: a few milliseconds and small vectors, for tests). Throws if a result is
/// wrong.
MachineLimits measure_machine(bool toy);

}  // namespace cgcontact::perf
