/// Loops of the host over all threads of the backend, as labelled Kokkos dispatches ("cgcontact::file::what", what a
/// Kokkos tool shows). Chunks do not depend on the number of threads, and their results are joined in order, so that
/// results are bitwise the same for any number of threads. A loop inside a loop, or without Kokkos started
/// (KokkosScope), runs on the calling thread. Only parallel.cpp sees Kokkos itself.
#pragma once

#include <cstddef>
#include <functional>

namespace cgcontact {

/// Starts Kokkos unless it runs already, and then stops it at the end of its life. threads = 0: the backend's default.
class KokkosScope {
 public:
  explicit KokkosScope(int threads);
  ~KokkosScope();
  KokkosScope(const KokkosScope&) = delete;
  KokkosScope& operator=(const KokkosScope&) = delete;

 private:
  bool owner_ = false;
};

/// A named stretch of the program, for Kokkos tools; without Kokkos started nothing.
class ProfiledRegion {
 public:
  explicit ProfiledRegion(const char* name);
  ~ProfiledRegion();
  ProfiledRegion(const ProfiledRegion&) = delete;
  ProfiledRegion& operator=(const ProfiledRegion&) = delete;

 private:
  bool open_ = false;
};

/// Items per chunk of a loop, some 50 microseconds of work: of items that take a microsecond or more (fits, cells,
/// polynomials), tenths of one (points that look for others), hundredths (sums).
constexpr std::size_t grain_of_heavy = 32, grain_of_medium = 256, grain_of_light = 4096;

/// Counts the chunks of `grain` items that n items make.
inline std::size_t num_chunks(std::size_t n, std::size_t grain) { return (n + grain - 1) / grain; }

/// Calls body(chunk) for all of [0, chunks). Throws what a loop on one thread would have thrown: the exception of the
/// lowest chunk.
void dispatch_chunks(const char* label, std::size_t chunks, const std::function<void(std::size_t)>& body);

/// Calls body(chunk, begin, end) for all chunks of [0, n).
template <class Body>
void parallel_chunks(const char* label, std::size_t n, std::size_t grain, const Body& body) {
  dispatch_chunks(label, num_chunks(n, grain), [&](std::size_t chunk) {
    const std::size_t begin = chunk * grain;
    body(chunk, begin, begin + grain < n ? begin + grain : n);
  });
}

/// Calls body(i) for all i in [0, n).
template <class Body>
void parallel_for(const char* label, std::size_t n, std::size_t grain, const Body& body) {
  parallel_chunks(label, n, grain, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

}  // namespace cgcontact
