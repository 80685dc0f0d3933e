// SPDX-License-Identifier: BSD-3-Clause
// The program `workspace` as a user runs it.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "run_program.h"
#include "study/workspace/refinement.h"

namespace soft_robot_lab {
namespace {

Outcome run_workspace(const SceneFolder& folder, const std::string& name, const std::string& arguments) {
  return run_program(SOFT_ROBOT_LAB_WORKSPACE, folder,
                     folder.path("robot.yaml") + " --output " + folder.path(name) + " " + arguments);
}

void write_robot(const SceneFolder& folder) {
  folder.write("robot.yaml", "include: bar.yaml\nbody: {element: linear}\n");
}

long lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

// As if the program had been stopped.
void forget_every_second_point(const std::string& journal) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(journal.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, "DELETE FROM outcomes WHERE rowid % 2", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
}

const char* const kNear = "--range left 0.95 1 --range right 0.95 1 ";

TEST(WorkspaceProgram, WritesTableAndPageTheSameForAnyNumberOfThreads) {
  const SceneFolder folder;
  write_robot(folder);
  const Outcome serial = run_workspace(folder, "one", std::string(kNear) + "--steps 4 --threads 1");
  ASSERT_EQ(serial.exit_status, 0) << serial.err;
  EXPECT_NE(serial.out.find("16 commands: 16 with a rest state"), std::string::npos) << serial.out;
  ASSERT_EQ(run_workspace(folder, "three", std::string(kNear) + "--steps 4 --threads 3").exit_status, 0);
  const std::string csv = contents(folder.path("one/results.csv"));
  EXPECT_EQ(lines(csv), 17);
  EXPECT_EQ(csv, contents(folder.path("three/results.csv")));
  const std::string page = contents(folder.path("one/workspace.html"));
  for (const std::string part : {"16 commands: 16 with a rest state", "data:image/svg+xml", "least singular value"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_NE(contents(folder.path("one/workspace_effort.csv")).find("largest tension [N]"), std::string::npos);
}

TEST(WorkspaceProgram, GoesOnWhereItWasStopped) {
  const SceneFolder folder;
  write_robot(folder);
  const std::string arguments = std::string(kNear) + "--steps 8 --threads 1";
  ASSERT_EQ(run_workspace(folder, "run", arguments).exit_status, 0);
  const std::string whole = contents(folder.path("run/results.csv"));
  forget_every_second_point(folder.path("run/journal.sqlite"));
  std::filesystem::remove(folder.path("run/results.csv"));
  const Outcome again = run_workspace(folder, "run", arguments);
  ASSERT_EQ(again.exit_status, 0) << again.err;
  EXPECT_NE(again.err.find("34 of 64 commands"), std::string::npos) << "began anew: " << again.err;
  EXPECT_EQ(contents(folder.path("run/results.csv")), whole);
}

// Its progress goes to who stops to listen, which ends it.
TEST(WorkspaceProgram, ShowsPointsAsTheyCome) {
  const SceneFolder folder;
  write_robot(folder);
  const std::string command = std::string(SOFT_ROBOT_LAB_WORKSPACE) + " " + folder.path("robot.yaml") + " --output " +
                              folder.path("run") + " " + kNear + "--steps 10 --threads 1 2>&1 >/dev/null | head -n 20";
  ASSERT_EQ(std::system((command + " >/dev/null").c_str()), 0);
  const std::string csv = contents(folder.path("run/results.csv"));
  EXPECT_EQ(lines(csv), 101) << "a row a command, also of those that are not asked yet";
  EXPECT_NE(csv.find("good"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder.path("run/workspace.html"))) << "it went to its end";
}

TEST(WorkspaceProgram, AsksSamplesOfSobolsSequence) {
  const SceneFolder folder;
  write_robot(folder);
  ASSERT_EQ(run_workspace(folder, "samples", std::string(kNear) + "--samples 10").exit_status, 0);
  EXPECT_EQ(lines(contents(folder.path("samples/results.csv"))), 11);
}

TEST(Refinement, GivesEachPointToTheGapWhosePartsAreLongest) {
  EXPECT_EQ(points_between({1.0, 4.0, 0.0, 1.5}, 2), (std::vector<int>{0, 2, 0, 0}));
  EXPECT_EQ(points_between({1.0, 4.0, 0.0, 1.5}, 5), (std::vector<int>{1, 3, 0, 1}));
  EXPECT_EQ(points_between({9.0, 0.0}, 100), (std::vector<int>{kMostBetween, 0})) << "a snap does not take them all";
}

// `right` moves the tip no less than `left` does, and a pull after a pull moves it farther.
TEST(WorkspaceProgram, AsksMoreWhereNeighbouringTipsAreFarthestApart) {
  const SceneFolder folder;
  write_robot(folder);
  const std::string even = "--range left 0.99 1 --range right 0.9 1 --steps 3 ";
  ASSERT_EQ(run_workspace(folder, "even", even).exit_status, 0);
  const Outcome refined = run_workspace(folder, "even", even + "--refine 6 --threads 3");
  ASSERT_EQ(refined.exit_status, 0) << refined.err;
  EXPECT_NE(refined.out.find("15 commands: 15 with a rest state"), std::string::npos) << refined.out;
  EXPECT_EQ(refined.err.find("0 of 9 commands"), std::string::npos) << "goes on from the grid";
  const std::string csv = contents(folder.path("even/results.csv"));
  ASSERT_EQ(run_workspace(folder, "at_once", even + "--refine 6 --threads 1").exit_status, 0);
  EXPECT_EQ(contents(folder.path("at_once/results.csv")), csv);
  for (const std::string between : {",0.99,0.925,", ",0.99,0.975,", ",1.0,0.925,", ",1.0,0.975,"})
    EXPECT_NE(csv.find(between), std::string::npos) << between << csv;
}

TEST(WorkspaceProgram, RefusesWhatTheRobotDoesNotHave) {
  const SceneFolder folder;
  write_robot(folder);
  const auto refusal = [&](const std::string& arguments) {
    const Outcome outcome = run_workspace(folder, "refused", arguments);
    EXPECT_EQ(outcome.exit_status, 2) << arguments;
    return outcome.err;
  };
  EXPECT_NE(refusal("--marker nose").find("known: tip, middle"), std::string::npos);
  EXPECT_NE(refusal("--range top 0.9 1").find("top"), std::string::npos);
  EXPECT_NE(refusal("--range left 0.9 9").find("must rise and lie in"), std::string::npos);
  EXPECT_NE(refusal("--samples 999999").find("must be at most 50000"), std::string::npos);
  EXPECT_NE(refusal("--refine 999999").find("must be at most 50000"), std::string::npos);
  EXPECT_NE(refusal("--steps 1").find("--steps"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder.path("refused")));
}

}  // namespace
}  // namespace soft_robot_lab
