/// Parallel loops: every item once, chunks in order, the first exception.
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/process/parallel.hpp"

namespace cgcontact::test_parallel {
namespace {

TEST(Parallel, VisitsEveryItemOnce) {
  for (std::size_t n : {0u, 1u, 7u, 8u, 1000u})
    for (std::size_t grain : {1u, 8u, 4096u}) {
      std::vector<int> visits(n, 0);
      parallel_for("test", n, grain, [&](std::size_t i) { ++visits[i]; });
      EXPECT_EQ(visits, std::vector<int>(n, 1));
    }
}

TEST(Parallel, ChunksDependOnTheGrainOnly) {
  std::vector<std::pair<std::size_t, std::size_t>> chunks(num_chunks(10, 4));
  parallel_chunks("test", 10, 4, [&](std::size_t c, std::size_t begin, std::size_t end) { chunks[c] = {begin, end}; });
  const std::vector<std::pair<std::size_t, std::size_t>> expected{{0, 4}, {4, 8}, {8, 10}};
  EXPECT_EQ(chunks, expected);
}

TEST(Parallel, ThrowsWhatALoopOnOneThreadWouldThrow) {
  for (int repeat = 0; repeat < 50; ++repeat) try {
      parallel_for("test", 1000, 1, [](std::size_t i) {
        if (i % 100 == 37) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "no exception";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "37");
    }
}

}  // namespace
}  // namespace cgcontact::test_parallel
