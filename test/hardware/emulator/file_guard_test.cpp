// SPDX-License-Identifier: BSD-3-Clause
// What an emulator that was killed leaves behind: nothing, and nothing of others is touched.
#include "hardware/emulator/file_guard.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

class Guarded : public testing::Test {
 protected:
  Guarded() : folder_(fs::temp_directory_path() / ("file_guard_test_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~Guarded() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static void touch(const std::string& path) { std::ofstream(path) << "mine"; }

  // A program that makes a link and a file, and is killed once it said so.
  void run_and_kill() {
    int said[2];
    ASSERT_EQ(pipe(said), 0);
    const pid_t program = fork();
    if (program == 0) {
      FileGuard guard({path("link"), path("socket")});
      fs::create_symlink("/nowhere", path("link"));
      guard.made(0);
      touch(path("socket"));
      guard.made(1);
      [[maybe_unused]] const ssize_t written = write(said[1], "x", 1);
      while (true) pause();
    }
    char byte = 0;
    ASSERT_EQ(read(said[0], &byte, 1), 1);
    kill(program, SIGKILL);
    waitpid(program, nullptr, 0);
    close(said[0]);
    close(said[1]);
  }

  bool gone(const std::string& name) const {
    for (int i = 0; i < 2000; ++i) {
      if (!fs::exists(fs::symlink_status(path(name)))) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }

  fs::path folder_;
};

TEST_F(Guarded, FilesOfAKilledProgramAreRemoved) {
  run_and_kill();
  EXPECT_TRUE(gone("link"));
  EXPECT_TRUE(gone("socket"));
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Guarded, AnothersFileOfTheSameNameStays) {
  {
    FileGuard guard({path("file")});
    touch(path("file"));
    guard.made(0);
    touch(path("other"));
    fs::rename(path("other"), path("file"));
  }
  EXPECT_TRUE(fs::exists(path("file")));
}

}  // namespace
}  // namespace soft_robot_lab
