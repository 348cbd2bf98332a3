#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/base/errors/errors.hpp"
#include "core/base/process/memory.hpp"
#include "core/base/process/resources.hpp"

namespace cgcontact::test_resources {
namespace {

/// A directory that goes away with its contents.
struct Hierarchy {
  std::string root = testing::TempDir() + "cgcontact_cgroup_" + std::to_string(getpid());
  ~Hierarchy() { std::filesystem::remove_all(root); }
  void write(const std::string& file, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(root + file).parent_path());
    std::ofstream(root + file) << text << '\n';
  }
};

TEST(Resources, quota_of_version_2_is_the_smallest_on_the_way_up) {
  const Hierarchy h;
  h.write("/a/b/cpu.max", "400000 100000");
  h.write("/a/cpu.max", "250000 100000");
  EXPECT_DOUBLE_EQ(cpu_quota("0::/a/b\n", h.root), 2.5);
  EXPECT_DOUBLE_EQ(cpu_quota("0::/a/b/gone\n", h.root), 2.5);
  EXPECT_DOUBLE_EQ(cpu_quota("0::/\n", h.root), 0) << "no file at the top";
  h.write("/cpu.max", "50000 100000");
  EXPECT_DOUBLE_EQ(cpu_quota("0::/\n", h.root), 0.5) << "a container's own mount";
}

TEST(Resources, quota_of_version_1) {
  const Hierarchy h;
  h.write("/cpu,cpuacct/job/cpu.cfs_quota_us", "300000");
  h.write("/cpu,cpuacct/job/cpu.cfs_period_us", "100000");
  h.write("/cpu,cpuacct/cpu.cfs_quota_us", "-1");
  h.write("/cpu,cpuacct/cpu.cfs_period_us", "100000");
  EXPECT_DOUBLE_EQ(cpu_quota("5:memory:/job\n4:cpu,cpuacct:/job\n", h.root), 3);
}

TEST(Resources, no_quota) {
  const Hierarchy h;
  h.write("/a/cpu.max", "max 100000");
  EXPECT_DOUBLE_EQ(cpu_quota("0::/a\n", h.root), 0);
  EXPECT_DOUBLE_EQ(cpu_quota("nonsense\n\n::\n", h.root), 0);
  EXPECT_DOUBLE_EQ(cpu_quota("", h.root), 0);
}

TEST(Memory, group_of_version_2_leaves_the_least_on_the_way_up) {
  const Hierarchy h;
  h.write("/a/b/memory.max", "max");
  h.write("/a/b/memory.current", "100");
  h.write("/a/memory.max", "1000");
  h.write("/a/memory.current", "700");
  h.write("/a/memory.stat", "anon 1\ninactive_file 200");
  EXPECT_DOUBLE_EQ(group_memory("0::/a/b\n", h.root), 500) << "1000 - (700 - 200 of file caches)";
  h.write("/memory.max", "300");
  h.write("/memory.current", "400");
  EXPECT_DOUBLE_EQ(group_memory("0::/a/b\n", h.root), 0) << "already over the limit";
}

TEST(Memory, group_of_version_1) {
  const Hierarchy h;
  h.write("/memory/job/memory.limit_in_bytes", "1000");
  h.write("/memory/job/memory.usage_in_bytes", "250");
  EXPECT_DOUBLE_EQ(group_memory("5:cpu:/job\n4:memory:/job\n", h.root), 750);
  EXPECT_TRUE(std::isinf(group_memory("5:cpu:/job\n", h.root)));
}

TEST(Memory, amounts) {
  EXPECT_DOUBLE_EQ(parse_memory("8GB"), 8e9);
  EXPECT_DOUBLE_EQ(parse_memory("1.5 gib"), 1.5 * (1 << 30));
  EXPECT_DOUBLE_EQ(parse_memory("2e6"), 2e6);
  EXPECT_TRUE(std::isinf(parse_memory("none")));
  for (const char* text : {"", "8 GX", "-1", "0", "nan", "inf", "1e999", "GB"})
    EXPECT_THROW(parse_memory(text), InputError) << text;
  EXPECT_EQ(memory_text(1.44e9), "1.44 GB");
  EXPECT_EQ(memory_text(85e6), "85 MB");
}

TEST(Memory, there_is_some) { EXPECT_GT(memory_budget().bytes, 1e6); }

TEST(Resources, there_is_a_thread) { EXPECT_GE(available_threads(), 1); }

}  // namespace
}  // namespace cgcontact::test_resources
