/// Kernels as large as their work.
#pragma once

#include <Kokkos_Core.hpp>
#include <cstddef>
#include <type_traits>

#include "core/base/process/parallel.hpp"

namespace cgcontact {

/// Takes all threads for the smallest kernels as well: for tests, whose systems are small.
inline bool all_threads_for_small_kernels = false;

/// Dispatches a kernel over a range. Where its `items` are no more than one chunk of a host loop (`grain`:
/// parallel.hpp), the calling thread runs it, as a labelled dispatch as well: waking others takes longer than the work
/// (docs/performance.md, "Two threads against one"). Results do not depend on which. On devices all kernels are the
/// device's.
template <class Policy, class Body>
void launch(const char* label, const Policy& policy, std::size_t items, std::size_t grain, const Body& body) {
#if defined(KOKKOS_ENABLE_OPENMP) && defined(KOKKOS_ENABLE_SERIAL)
  if constexpr (std::is_same_v<typename Policy::execution_space, Kokkos::OpenMP>)
    if (items <= grain && !all_threads_for_small_kernels)
      return Kokkos::parallel_for(label, Kokkos::RangePolicy<Kokkos::Serial>(policy.begin(), policy.end()), body);
#endif
  static_cast<void>(items);
  static_cast<void>(grain);
  Kokkos::parallel_for(label, policy, body);
}

/// The same, one item per index.
template <class Policy, class Body>
void launch(const char* label, const Policy& policy, std::size_t grain, const Body& body) {
  launch(label, policy, static_cast<std::size_t>(policy.end() - policy.begin()), grain, body);
}

}  // namespace cgcontact
