/// Folders that go while other threads write to them.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>

#include "core/program/interruption.hpp"
#include "core/program/scratch_folder.hpp"

namespace cgcontact {
namespace {

namespace fs = std::filesystem;

class ScratchFolders : public testing::Test {
 protected:
  const fs::path root_ = fs::path(testing::TempDir()) / ("scratch_" + std::to_string(getpid()));
  ~ScratchFolders() override { fs::remove_all(root_); }
};

TEST_F(ScratchFolders, GoWhileThreadsWrite) {
  for (int turn = 0; turn < 20; ++turn) {
    std::optional<ScratchFolder> folder(root_ / "result");
    std::atomic<int> written{0};
    std::atomic<bool> over{false};
    const auto write = [&, path = folder->path()](const std::string& name) {
      for (int file = 0; !over; ++file)
        if (std::ofstream(path / (name + std::to_string(file))) << "half") ++written;
    };
    std::thread one(write, "one"), other(write, "other");
    while (written < 100) std::this_thread::yield();
    folder.reset();
    EXPECT_TRUE(fs::is_empty(root_)) << turn;
    over = true;
    one.join();
    other.join();
    EXPECT_TRUE(fs::is_empty(root_)) << turn;
  }
}

/// A signal while it is being removed, when its name is gone and most of its many files are not.
TEST_F(ScratchFolders, GoWhollyWhenTheProgramIsStopped) {
  constexpr int files = 3000;
  const pid_t child = fork();
  if (child == 0) {
    const InterruptionWatch watch;
    {
      const ScratchFolder folder(root_ / "result");
      for (int file = 0; file < files; ++file) std::ofstream(folder.path() / std::to_string(file)) << "half";
      std::ofstream(root_ / "written") << "all";
    }
    pause();
  }
  while (!fs::exists(root_ / "written") || fs::exists(root_ / "result")) std::this_thread::yield();
  kill(child, SIGTERM);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
  EXPECT_TRUE(fs::remove(root_ / "written"));
  EXPECT_TRUE(fs::is_empty(root_));
}

TEST_F(ScratchFolders, BeginEmptyAndCanMoveAway) {
  fs::create_directories(root_ / "result" / "remains");
  fs::create_directories(root_ / (std::string("result") + ScratchFolder::removed_mark) / "remains");
  {
    const ScratchFolder folder(root_ / "result");
    EXPECT_TRUE(fs::is_empty(folder.path()));
    std::ofstream(folder.path() / "file") << "whole";
    fs::rename(folder.path(), root_ / "target");
  }
  EXPECT_TRUE(fs::exists(root_ / "target" / "file"));
  EXPECT_TRUE(fs::remove_all(root_ / "target"));
  EXPECT_TRUE(fs::is_empty(root_));
}

TEST_F(ScratchFolders, CannotBeMadeInAFile) {
  fs::create_directories(root_);
  std::ofstream(root_ / "file") << "mine";
  EXPECT_THROW(ScratchFolder(root_ / "file" / "result"), fs::filesystem_error);
}

}  // namespace
}  // namespace cgcontact
