// SPDX-License-Identifier: BSD-3-Clause
// Bad studies end with a message that names key, value and range, and leave the journal whole.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "running_study.h"
#include "settings/written_options.h"
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

TEST(BadStudy, WritesNothingOutsideOfItsFolder) {
  for (const std::string argument : {"--output", "--output=../outside"})
    expect_refused("parameters: {height: {values: [0.02]}}\narguments: [" + argument + "]\n",
                   "arguments[0]: '--output' is set by the study itself");
  for (const std::string& option : written_options())
    expect_refused("parameters: {height: {values: [0.02]}}\narguments: [" + option + ", ../outside]\n",
                   "arguments[0]: '" + option + "' is set by the study itself");
}

TEST(BadStudy, RefusesAFolderThatOthersMayWriteTo) {
  const SceneFolder folder;
  short_scene(folder);
  std::filesystem::create_directory(folder.path("found"));
  std::filesystem::permissions(folder.path("found"), std::filesystem::perms::all);
  const Outcome outcome =
      run_study(folder, "program: simulate\nscene: short.yaml\nparameters: {height: {values: [0.02]}}\n", "found", "");
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE(outcome.err.find("others may write there"), std::string::npos) << outcome.err;
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

TEST(BadStudy, SecondOneOnAJournalEndsWithAMessageAndTheFirstGoesOn) {
  const SceneFolder folder;
  short_scene(folder);
  const std::string file = folder.write("study.yaml", short_study("20"));
  const pid_t first = start({SOFT_ROBOT_LAB_STUDY_PROGRAM, file, "--workers", "1", "--output", folder.path("found")});
  const std::string journal = folder.path("found/journal.sqlite");
  for (int i = 0; i < 6000 && outcomes_in(journal) < 1; ++i) usleep(5000);
  kill(first, SIGSTOP);  // or it may end before the second one starts
  const Outcome second = run_study(folder, short_study("2"), "found", "");
  kill(first, SIGCONT);
  EXPECT_EQ(second.exit_status, 2);
  EXPECT_NE(second.err.find("another study writes to its journal"), std::string::npos) << second.err;
  int status = -1;
  waitpid(first, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(outcomes_in(journal), 20);
  EXPECT_EQ(ask(journal, "PRAGMA integrity_check"), "ok");
}

TEST(BadStudy, RefusesAJournalThatIsNone) {
  const SceneFolder folder;
  short_scene(folder);
  std::filesystem::create_directory(folder.path("found"));
  folder.write("found/journal.sqlite", std::string(5000, 'x'));
  const Outcome outcome = run_study(folder, short_study("2"), "found", "");
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE(outcome.err.find("is no journal of a study"), std::string::npos) << outcome.err;
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
  EXPECT_EQ(ask(folder.path("found/journal.sqlite"), "PRAGMA integrity_check"), "ok");
  const Outcome after = run_program(SOFT_ROBOT_LAB_STUDY_PROGRAM, folder, study + command);
  EXPECT_EQ(after.exit_status, 0) << after.err;
  EXPECT_EQ(contents(folder.path("found/results.csv")), contents(folder.path("whole/results.csv")));
}

}  // namespace
}  // namespace soft_robot_lab
