#include "core/base/process/parallel.hpp"

#include <atomic>
#include <exception>
#include <mutex>
#include <string>
#include <vector>

#ifndef CGCONTACT_CORE_ONLY
#include <Kokkos_Core.hpp>
#endif

namespace cgcontact {
namespace {

/// Set while this thread works on a chunk.
thread_local bool inside_a_loop = false;

/// The exception that a loop on one thread would have thrown: that of the lowest chunk.
class FirstError {
 public:
  /// Runs body(chunk) unless a lower chunk has failed already.
  void guard(std::size_t chunk, const std::function<void(std::size_t)>& body) {
    if (chunk > failed_) return;
    inside_a_loop = true;
    try {
      body(chunk);
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (chunk < failed_) {
        failed_ = chunk;
        error_ = std::current_exception();
      }
    }
    inside_a_loop = false;
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::atomic<std::size_t> failed_{~std::size_t(0)};
  std::mutex mutex_;
  std::exception_ptr error_;
};

void run_on_this_thread(std::size_t chunks, const std::function<void(std::size_t)>& body) {
  for (std::size_t c = 0; c < chunks; ++c) body(c);
}

}  // namespace

#ifdef CGCONTACT_CORE_ONLY  // fuzz targets: no Kokkos

KokkosScope::KokkosScope(int) {}
KokkosScope::~KokkosScope() = default;
ProfiledRegion::ProfiledRegion(const char*) {}
ProfiledRegion::~ProfiledRegion() = default;

void dispatch_chunks(const char*, std::size_t chunks, const std::function<void(std::size_t)>& body) {
  run_on_this_thread(chunks, body);
}

#else

KokkosScope::KokkosScope(int threads) {
  if (Kokkos::is_initialized()) return;
#if KOKKOS_VERSION >= 30700
  std::string option = "--kokkos-num-threads=" + std::to_string(threads);
#else
  std::string option = "--kokkos-threads=" + std::to_string(threads);
#endif
  std::string program = "cgcontact";
  // On binding and on the number of threads: the program's own task.
  std::string no_warnings = "--kokkos-disable-warnings";
  std::vector<char*> arguments{program.data(), no_warnings.data()};
  if (threads > 0) arguments.push_back(option.data());
  int argc = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  Kokkos::initialize(argc, arguments.data());
  owner_ = true;
}
KokkosScope::~KokkosScope() {
  if (owner_) Kokkos::finalize();
}

ProfiledRegion::ProfiledRegion(const char* name) : open_(Kokkos::is_initialized() && !inside_a_loop) {
  if (open_) Kokkos::Profiling::pushRegion(name);
}
ProfiledRegion::~ProfiledRegion() {
  if (open_ && Kokkos::is_initialized()) Kokkos::Profiling::popRegion();
}

void dispatch_chunks(const char* label, std::size_t chunks, const std::function<void(std::size_t)>& body) {
  if (inside_a_loop || !Kokkos::is_initialized()) return run_on_this_thread(chunks, body);
  using Space = Kokkos::DefaultHostExecutionSpace;
  using Policy = Kokkos::RangePolicy<Space, Kokkos::Schedule<Kokkos::Dynamic>, Kokkos::IndexType<std::size_t> >;
  FirstError error;
  Kokkos::parallel_for(label, Policy(0, chunks, Kokkos::ChunkSize(1)), [&](std::size_t c) { error.guard(c, body); });
  Space().fence();
  error.rethrow();
}

#endif

}  // namespace cgcontact
