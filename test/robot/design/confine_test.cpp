// SPDX-License-Identifier: BSD-3-Clause
// What the mesher can do no more once it is confined.
#include "programs/mesher/confine.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include <gtest/gtest.h>
#include <linux/landlock.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "settings/limits.h"

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

class Confined : public testing::Test {
 protected:
  Confined() {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "inside");
  }
  ~Confined() override { fs::remove_all(folder_); }

  // Whether it holds in a process that is confined.
  bool holds(const std::function<bool()>& rule) {
    const pid_t child = fork();
    if (child == 0) {
      confine_to(folder_ / "inside");
      _exit(rule() ? 0 : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

  static bool can_write(const fs::path& file) {
    std::ofstream(file) << "text";
    return fs::exists(file);
  }

  static bool has_seccomp() { return prctl(PR_GET_SECCOMP) == 0; }
  static long landlock_version() {
    return syscall(__NR_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / "confine_test";
};

TEST_F(Confined, StartsNoProcesses) {
  if (!has_seccomp()) GTEST_SKIP() << "the kernel has no seccomp";
  const std::string mark = folder_ / "inside" / "mark", command = "echo run > '" + mark + "'";
  EXPECT_TRUE(holds([&] { return std::system(command.c_str()) != 0 && !fs::exists(mark); }));
  EXPECT_TRUE(holds([&] { return popen(command.c_str(), "r") == nullptr || !fs::exists(mark); }));
  EXPECT_TRUE(holds([] { return fork() < 0; }));
  EXPECT_TRUE(holds([] { return execl("/bin/true", "true", nullptr) < 0; }));
  EXPECT_TRUE(holds([] { return socket(AF_INET, SOCK_STREAM, 0) < 0; }));
}

TEST_F(Confined, StillHasThreadsAndItsFolder) {
  EXPECT_TRUE(holds([] {
    bool ran = false;
    std::thread([&] { ran = true; }).join();
    return ran;
  }));
  EXPECT_TRUE(holds([&] { return can_write(folder_ / "inside" / "file"); }));
  EXPECT_TRUE(holds([&] {
    fs::rename(folder_ / "inside" / "file", folder_ / "inside" / "other");
    return fs::remove(folder_ / "inside" / "other");
  }));
}

TEST_F(Confined, WritesNothingOutsideOfItsFolder) {
  if (landlock_version() < 1) GTEST_SKIP() << "the kernel has no Landlock";
  std::ofstream(folder_ / "kept") << "text";
  EXPECT_TRUE(holds([&] { return !can_write(folder_ / "file"); }));
  EXPECT_TRUE(holds([&] { return std::remove((folder_ / "kept").c_str()) != 0; }));
  if (landlock_version() >= 3) {
    EXPECT_TRUE(holds([&] { return truncate((folder_ / "kept").c_str(), 0) != 0; }));
  }
  EXPECT_TRUE(fs::exists(folder_ / "kept"));
}

TEST_F(Confined, TakesNoMoreMemoryThanItMay) {
  if (kSanitisesAddresses) GTEST_SKIP() << "the address sanitiser needs more";
  EXPECT_TRUE(holds([] {
    rlimit limit{};
    getrlimit(RLIMIT_AS, &limit);
    return limit.rlim_max <= static_cast<rlim_t>(limits::kMemory_gb * 1e9);
  }));
}

}  // namespace
}  // namespace soft_robot_lab
