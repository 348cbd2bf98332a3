#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/resources.hpp"

namespace cgcontact {
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

TEST(Resources, there_is_a_thread) { EXPECT_GE(available_threads(), 1); }

}  // namespace
}  // namespace cgcontact
