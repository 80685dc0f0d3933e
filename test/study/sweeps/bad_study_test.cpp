// SPDX-License-Identifier: BSD-3-Clause
// Bad studies end with a message that names key, value and range, and leave the journal whole.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "study_run.h"

namespace soft_robot_lab {
namespace {

void expect_refused(const std::string& keys, const std::string& message) {
  const SceneFolder folder;
  short_scene(folder);
  const Outcome outcome = run_study(folder, "program: simulate\nscene: short.yaml\n" + keys, "found", "");
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE(outcome.err.find(message), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder.path("found")));
}

TEST(BadStudy, NamesAnUnknownPath) {
  expect_refused("parameters: {body.material.youngs_modulus: {values: [1]}}\n",
                 "study.yaml:3: parameters.body.material.youngs_modulus: there is no 'body.material.youngs_modulus'");
  expect_refused("parameters:\n  body.solid.box.size_m[3]: {values: [1]}\n",
                 "no '[3]' in 'body.solid.box.size_m'; it is a list of 3");
  expect_refused("parameters: {markers.tap.position_m: {values: [1]}}\n",
                 "no 'tap' in 'markers'; it is a list of 2: tip, middle");
}

TEST(BadStudy, NamesAnEmptyRange) {
  expect_refused("parameters: {body.material.density_kg_m3: {range: [2, 1], steps: 2}}\n",
                 "range: is empty: 2 must be less than 1");
  expect_refused("parameters: {body.material.density_kg_m3: {values: []}}\n", "values: is empty");
}

TEST(BadStudy, NamesAValueBeyondTheRangeThatTheFileGives) {
  expect_refused("parameters: {height: {values: [0.05]}}\n",
                 "parameter 'height': 0.05 is out of range [0.01, 0.03] of the file's parameters.height.range");
}

TEST(BadStudy, NamesAnUnknownMethodAndWhatAGridLacks) {
  expect_refused("method: random\nparameters: {height: {}}\n",
                 "'random' is not one of grid, latin_hypercube, sobol, sobol_indices");
  expect_refused("parameters: {height: {}}\n", "key 'steps' is missing");
  expect_refused("parameters: {height: {steps: 2}}\nsamples: 3\n", "samples: has no use with method grid");
}

TEST(BadStudy, KeepsTheReasonOfASolidThatIsEmpty) {
  const SceneFolder folder;
  short_scene(folder);
  folder.write("short.yaml",
               "include: bar.yaml\ncables: []\nbody:\n  solid:\n    difference:\n"
               "      - box: {size_m: [0.1, 0.02, 0.02], center_m: [0.05, 0, 0]}\n"
               "      - box: {size_m: [0.01, 0.03, 0.03], center_m: [0.08, 0, 0]}\n");
  const Outcome outcome = run_study(folder,
                                    "program: simulate\nscene: short.yaml\nparameters:\n"
                                    "  body.solid.difference[1].box.size_m[0]: {values: [0.5]}\n",
                                    "found", "");
  EXPECT_EQ(outcome.exit_status, 1);
  EXPECT_NE(contents(folder.path("found/results.csv")).find("failed,"), std::string::npos);
  EXPECT_NE(outcome.out.find("1 failed"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("reason simulate: "), std::string::npos) << outcome.out;
}

TEST(BadStudy, SecondOneOnAJournalEndsWithAMessage) {
  const SceneFolder folder;
  short_scene(folder);
  std::filesystem::create_directory(folder.path("found"));
  const int lock = open(folder.path("found/journal.lock").c_str(), O_RDWR | O_CREAT, 0600);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  const Outcome outcome = run_study(folder, short_study("2"), "found", "");
  close(lock);
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE(outcome.err.find("another study writes to its journal"), std::string::npos) << outcome.err;
}

TEST(BadStudy, LeavesTheJournalWholeOnAFullDisk) {
  const SceneFolder folder;
  short_scene(folder);
  const std::string study = folder.write("study.yaml", short_study("40"));
  ASSERT_EQ(run_study(folder, short_study("40"), "whole", "--workers 2").exit_status, 0);
  const std::string command = " --workers 2 --output " + folder.path("found");
  const Outcome full =
      run_program("trap '' XFSZ; ulimit -f 64; " SOFT_ROBOT_LAB_STUDY_PROGRAM, folder, study + command);
  EXPECT_EQ(full.exit_status, 1);
  EXPECT_NE(full.err.find("journal.sqlite: cannot be written"), std::string::npos) << full.err;
  const Outcome after = run_program(SOFT_ROBOT_LAB_STUDY_PROGRAM, folder, study + command);
  EXPECT_EQ(after.exit_status, 0) << after.err;
  EXPECT_EQ(contents(folder.path("found/results.csv")), contents(folder.path("whole/results.csv")));
}

}  // namespace
}  // namespace soft_robot_lab
