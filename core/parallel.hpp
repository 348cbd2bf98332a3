/// Loops over all threads of the backend: OpenMP's where the program is built with it, else the calling thread alone.
/// The split into chunks does not depend on the number of threads; what a chunk leaves behind is put together in the
/// order of the chunks, so that results are the same to the last bit for any number of threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>

namespace cgcontact {

/// Number of chunks of `grain` items that n items make.
inline std::size_t num_chunks(std::size_t n, std::size_t grain) { return (n + grain - 1) / grain; }

/// The exception that a loop on one thread would have thrown: that of the lowest chunk.
class FirstError {
 public:
  /// Runs work() unless a lower chunk has failed already.
  template <class Work>
  void guard(long long chunk, const Work& work) {
    if (chunk > failed_) return;
    try {
      work();
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (chunk >= failed_) return;
      failed_ = chunk;
      error_ = std::current_exception();
    }
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::atomic<long long> failed_{1LL << 62};
  std::mutex mutex_;
  std::exception_ptr error_;
};

/// Calls body(chunk, begin, end) for all chunks of [0, n).
template <class Body>
void parallel_chunks(std::size_t n, std::size_t grain, const Body& body) {
  const auto chunks = static_cast<long long>(num_chunks(n, grain));
  FirstError error;
  const auto run = [&](long long c) {
    error.guard(c, [&] {
      const std::size_t begin = static_cast<std::size_t>(c) * grain;
      body(static_cast<std::size_t>(c), begin, begin + grain < n ? begin + grain : n);
    });
  };
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic) if (chunks > 1)
#endif
  for (long long c = 0; c < chunks; ++c) run(c);
  error.rethrow();
}

/// Calls body(i) for all i in [0, n). `grain`: items that are worth handing to another thread (some 50 microseconds).
template <class Body>
void parallel_for(std::size_t n, std::size_t grain, const Body& body) {
  parallel_chunks(n, grain, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

}  // namespace cgcontact
