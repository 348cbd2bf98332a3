#include "perf/machine_limits.hpp"

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <stdexcept>

#if defined(__AVX__) || defined(__SSE2__)
#include <immintrin.h>
#endif

namespace cgcontact::perf {
namespace {

/// Entries of a chunk are a multiple of a cache line, so that no two threads share one.
constexpr std::size_t line = 8;

template <class Work>
void for_each_thread(const char* label, const Work& work) {
  const ExecSpace exec;
  const int threads = ExecSpace::concurrency();
  Kokkos::parallel_for(label, Kokkos::RangePolicy<ExecSpace>(exec, 0, threads, Kokkos::ChunkSize(1)),
                       [=](const int thread) { work(thread, threads); });
  exec.fence();
}

struct Range {
  std::size_t begin, end;
};

Range chunk_of(std::size_t size, int thread, int threads) {
  const std::size_t lines = size / line;
  return {lines * thread / threads * line, lines * (thread + 1) / threads * line};
}

void triad(double* a, const double* b, const double* c, double s, Range range) {
  for (std::size_t i = range.begin; i < range.end; ++i) a[i] = b[i] + s * c[i];
}

#if defined(__AVX512F__)
#define CGCONTACT_STREAMING 1
void streaming_triad(double* a, const double* b, const double* c, double s, Range range) {
  const __m512d factor = _mm512_set1_pd(s);
  for (std::size_t i = range.begin; i < range.end; i += 8)
    _mm512_stream_pd(a + i, _mm512_fmadd_pd(factor, _mm512_load_pd(c + i), _mm512_load_pd(b + i)));
  _mm_sfence();
}
#elif defined(__AVX__)
#define CGCONTACT_STREAMING 1
void streaming_triad(double* a, const double* b, const double* c, double s, Range range) {
  const __m256d factor = _mm256_set1_pd(s);
  for (std::size_t i = range.begin; i < range.end; i += 4)
    _mm256_stream_pd(a + i, _mm256_add_pd(_mm256_mul_pd(factor, _mm256_load_pd(c + i)), _mm256_load_pd(b + i)));
  _mm_sfence();
}
#elif defined(__SSE2__)
#define CGCONTACT_STREAMING 1
void streaming_triad(double* a, const double* b, const double* c, double s, Range range) {
  const __m128d factor = _mm_set1_pd(s);
  for (std::size_t i = range.begin; i < range.end; i += 2)
    _mm_stream_pd(a + i, _mm_add_pd(_mm_mul_pd(factor, _mm_load_pd(c + i)), _mm_load_pd(b + i)));
  _mm_sfence();
}
#else
#define CGCONTACT_STREAMING 0
void streaming_triad(double* a, const double* b, const double* c, double s, Range range) { triad(a, b, c, s, range); }
#endif

/// Asks for large pages before the first touch: the ceiling is what the machine can do, and small pages cost a third of
/// the bandwidth on virtual machines.
void ask_for_large_pages([[maybe_unused]] const RealView& v) {
#if defined(MADV_HUGEPAGE)
  constexpr std::uintptr_t page = 4096;
  const auto address = reinterpret_cast<std::uintptr_t>(v.data());
  const std::uintptr_t begin = (address + page - 1) / page * page;
  const std::uintptr_t end = (address + v.size() * sizeof(double)) / page * page;
  if (end > begin) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#endif
}

constexpr double factor = 3;
double b_value(std::size_t i) { return static_cast<double>(i % 7 + 1); }
double c_value(std::size_t i) { return static_cast<double>(i % 5 + 2); }

#if defined(__AVX512F__)
constexpr int num_lanes = 8;
#elif defined(__AVX__)
constexpr int num_lanes = 4;
#else
constexpr int num_lanes = 2;
#endif
constexpr int num_chains = 16;
constexpr int num_steps = 1 << 16;
constexpr double increment = 1.0 / (1 << 20);  // sums of it are exact

using Lanes __attribute__((vector_size(num_lanes * sizeof(double)))) = double;

/// chain = chain * one + increment, num_steps times. `one` and `step` are not known to the compiler.
void run_chains(double one, double step, double* sums) {
  Lanes chain[num_chains], x, y;
  for (int l = 0; l < num_lanes; ++l) x[l] = one, y[l] = step;
  for (int c = 0; c < num_chains; ++c)
    for (int l = 0; l < num_lanes; ++l) chain[c][l] = c + l;
  for (int n = 0; n < num_steps; ++n)
#pragma GCC unroll 16
    for (int c = 0; c < num_chains; ++c) chain[c] = chain[c] * x + y;
  for (int c = 0; c < num_chains; ++c)
    for (int l = 0; l < num_lanes; ++l) sums[c * num_lanes + l] = chain[c][l];
}

template <class Work>
double shortest(int repetitions, const Work& work) {
  double best = 1e300;
  for (int i = 0; i < repetitions; ++i) {
    const double start = now();
    work();
    best = std::min(best, now() - start);
  }
  return best;
}

}  // namespace

double now() {
  if (ExecSpace::concurrency() == 1) {
    std::timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Triad::Triad(std::size_t size)
    : size_(size / line * line),
      a_(Kokkos::view_alloc("cgcontact::perf::a", Kokkos::WithoutInitializing), size_),
      b_(Kokkos::view_alloc("cgcontact::perf::b", Kokkos::WithoutInitializing), size_),
      c_(Kokkos::view_alloc("cgcontact::perf::c", Kokkos::WithoutInitializing), size_) {
  for (const RealView& v : {a_, b_, c_}) ask_for_large_pages(v);
  const auto a = a_, b = b_, c = c_;
  const std::size_t n = size_;
  // Every thread touches its chunk first: the pages lie near it.
  for_each_thread("cgcontact::perf::triad_start", [=](int thread, int threads) {
    const Range range = chunk_of(n, thread, threads);
    for (std::size_t i = range.begin; i < range.end; ++i) {
      a(i) = 0;
      b(i) = b_value(i);
      c(i) = c_value(i);
    }
  });
}

void Triad::run(bool streaming) const {
  double *const a = a_.data(), *const b = b_.data(), *const c = c_.data();
  const std::size_t n = size_;
  for_each_thread("cgcontact::perf::triad", [=](int thread, int threads) {
    (streaming ? streaming_triad : triad)(a, b, c, factor, chunk_of(n, thread, threads));
  });
}

double Triad::error() const {
  double largest = 0;
  for (std::size_t i = 0; i < size_; ++i)
    largest = std::max(largest, std::abs(a_(i) - (b_value(i) + factor * c_value(i))));
  return largest;
}

bool Triad::has_streaming_stores() { return CGCONTACT_STREAMING; }

FmaChains::FmaChains() : sums_("cgcontact::perf::sums", ExecSpace::concurrency(), num_chains * num_lanes) {}

void FmaChains::run() const {
  static volatile double one = 1, step = increment;
  const double x = one, y = step;
  const auto sums = sums_;
  for_each_thread("cgcontact::perf::fma", [=](int thread, int) { run_chains(x, y, &sums(thread, 0)); });
}

double FmaChains::error() const {
  double largest = 0;
  for (std::size_t t = 0; t < sums_.extent(0); ++t)
    for (int c = 0; c < num_chains; ++c)
      for (int l = 0; l < num_lanes; ++l)
        largest = std::max(largest, std::abs(sums_(t, c * num_lanes + l) - (c + l + num_steps * increment)));
  return largest;
}

double FmaChains::flop() const { return 2.0 * num_steps * num_chains * num_lanes * ExecSpace::concurrency(); }

int FmaChains::lanes() { return num_lanes; }

MachineLimits measure_machine(bool toy) {
  MachineLimits limits;
  limits.threads = ExecSpace::concurrency();
  const Triad triad(toy ? 1u << 14 : 1u << 23);  // 3 x 64 MB: beyond any cache
  const int repetitions = toy ? 3 : 25;
  for (const bool streaming : {false, true}) {
    triad.run(streaming);
    const double best = triad.bytes(streaming) / shortest(repetitions, [&] { triad.run(streaming); });
    (streaming ? limits.triad_streaming : limits.triad) = best;
    if (triad.error() != 0) throw std::logic_error("the triad's result is wrong");
  }
  const FmaChains chains;
  limits.fma = chains.flop() / shortest(toy ? 3 : 200, [&] { chains.run(); });
  if (chains.error() != 0) throw std::logic_error("the multiply-adds' result is wrong");
  return limits;
}

}  // namespace cgcontact::perf
