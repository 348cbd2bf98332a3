/// Kernels as large as their work; all tests of this folder run their kernels on all threads.
#include <gtest/gtest.h>

#include <Kokkos_Core.hpp>
#ifdef KOKKOS_ENABLE_OPENMP
#include <omp.h>
#endif

#include "kernels/mesh/launch.hpp"

namespace cgcontact::test_launch {
namespace {

/// Set before any test runs: races of kernels show on systems of any size.
[[maybe_unused]] const bool all_threads = (all_threads_for_small_kernels = true);

using Space = Kokkos::DefaultHostExecutionSpace;
using View = Kokkos::View<int*, Space>;

/// Counts visits of the indices in [3, 20), with `items` told to be there.
View visits(std::size_t items, std::size_t grain) {
  View count("count", 24);
  launch(
      "test_launch::count", Kokkos::RangePolicy<Space>(3, 20), items, grain, KOKKOS_LAMBDA(int i) { ++count(i); });
  Space().fence();
  return count;
}

TEST(Launch, VisitsEveryIndexOnce) {
  for (const bool all : {false, true}) {
    all_threads_for_small_kernels = all;
    for (const std::size_t items : {std::size_t{17}, std::size_t{4096}, std::size_t{4097}}) {
      const View count = visits(items, grain_of_light);
      for (int i = 0; i < 24; ++i) EXPECT_EQ(count(i), i >= 3 && i < 20) << i << ' ' << items;
    }
  }
}

TEST(Launch, CountsIndicesUnlessTold) {
  all_threads_for_small_kernels = false;
  View count("count", 5);
  launch(
      "test_launch::count", Kokkos::RangePolicy<Space>(0, 5), grain_of_heavy, KOKKOS_LAMBDA(int i) { ++count(i); });
  Space().fence();
  for (int i = 0; i < 5; ++i) EXPECT_EQ(count(i), 1);
  all_threads_for_small_kernels = true;
}

#ifdef KOKKOS_ENABLE_OPENMP
/// Small kernels run on the calling thread, others on all.
TEST(Launch, KeepsSmallKernelsOnTheCallingThread) {
  if (Space::concurrency() < 2) GTEST_SKIP() << "one thread";
  for (const bool all : {false, true}) {
    all_threads_for_small_kernels = all;
    for (const std::size_t items : {std::size_t{32}, std::size_t{33}}) {
      View threads("threads", 2);
      launch(
          "test_launch::threads", Kokkos::RangePolicy<Space>(0, 2), items, grain_of_heavy,
          KOKKOS_LAMBDA(int i) { threads(i) = omp_get_num_threads(); });
      Space().fence();
      EXPECT_EQ(threads(0) > 1, all || items > 32) << items;
    }
  }
  all_threads_for_small_kernels = true;
}
#endif

}  // namespace
}  // namespace cgcontact::test_launch
