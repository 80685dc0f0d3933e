// SPDX-License-Identifier: BSD-3-Clause
#include "settings/find_program.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

namespace fs = std::filesystem;

TEST(FindProgram, LooksBesideTheRunningProgramFirst) {
  EXPECT_EQ(find_program("find_program_test"), program_folder() + "/find_program_test");
}

TEST(FindProgram, LooksOnPath) {
  ASSERT_EQ(setenv("PATH", "/nonexistent:/bin", 1), 0);
  EXPECT_EQ(find_program("sh"), "/bin/sh");
}

TEST(FindProgram, TakesNeitherFoldersNorWhatMayNotRun) {
  const fs::path folder = fs::path(testing::TempDir()) / "find_program";
  fs::create_directories(folder / "a_folder");
  std::ofstream(folder / "a_text") << "words\n";
  ASSERT_EQ(setenv("PATH", folder.c_str(), 1), 0);
  EXPECT_EQ(find_program("a_folder"), "");
  EXPECT_EQ(find_program("a_text"), "");
  EXPECT_EQ(find_program("no_such_program"), "");
}

}  // namespace
}  // namespace soft_robot_lab
