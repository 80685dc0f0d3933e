// SPDX-License-Identifier: BSD-3-Clause
// The program `study` as a user runs it.
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "study/sweeps/results_table.h"
#include "study_run.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string cell(const std::string& csv, std::size_t row, const std::string& column) {
  const std::vector<std::string> lines = lines_of(csv);
  std::istringstream names(lines.at(0)), cells(lines.at(row));
  for (std::string name, value; std::getline(names, name, ',') && std::getline(cells, value, ',');)
    if (name == column) return value;
  return "no column " + column;
}

TEST(Study, FindsWhatTheProgramFindsAloneForAnyNumberOfWorkers) {
  const SceneFolder folder;
  short_scene(folder);
  const std::string text =
      "program: simulate\nscene: short.yaml\nparameters:\n"
      "  body.material.youngs_modulus_pa: {values: [2.0e+5, 4.0e+5]}\n  height: {steps: 2}\n";
  const Outcome serial = run_study(folder, text, "serial", "--workers 1");
  ASSERT_EQ(serial.exit_status, 0) << serial.err;
  ASSERT_EQ(run_study(folder, text, "three", "--workers 3").exit_status, 0);
  const std::string csv = contents(folder.path("serial/results.csv"));
  EXPECT_EQ(csv, contents(folder.path("three/results.csv")));
  EXPECT_EQ(contents(folder.path("serial/results.npy")), contents(folder.path("three/results.npy")));
  EXPECT_EQ(lines_of(csv).size(), 5u);
  const Outcome alone =
      run_program(SOFT_ROBOT_LAB_SIMULATE, folder,
                  folder.path("short.yaml") + " --set body.material.youngs_modulus_pa=4e5 --set height=0.01 --result " +
                      folder.path("alone.json"));
  ASSERT_EQ(alone.exit_status, 0) << alone.err;
  const Json result = Json::parse(contents(folder.path("alone.json")));
  EXPECT_EQ(cell(csv, 3, "markers.tip.position_m.y"), result["markers"]["tip"]["position_m"][1].dump());
  EXPECT_EQ(cell(csv, 3, "height"), "0.01");
  EXPECT_EQ(cell(csv, 3, "state"), "good");
  EXPECT_TRUE(std::filesystem::exists(folder.path("serial/report.html")));
}

TEST(Study, RunsNothingTwice) {
  const SceneFolder folder;
  short_scene(folder);
  ASSERT_EQ(run_study(folder, short_study("3"), "found", "").exit_status, 0);
  const auto written = std::filesystem::last_write_time(folder.path("found/journal.sqlite"));
  const std::string csv = contents(folder.path("found/results.csv"));
  const Outcome again =
      run_study(folder, short_study("3"), "found", "--hosts " + folder.write("hosts", "nowhere\n") + " --ssh false");
  EXPECT_EQ(again.exit_status, 0) << "asked a worker that cannot run: " << again.err;
  EXPECT_EQ(contents(folder.path("found/results.csv")), csv);
  EXPECT_GE(std::filesystem::last_write_time(folder.path("found/journal.sqlite")), written);
}

TEST(Study, SaysWhyARobotCannotBeCast) {
  const SceneFolder folder;
  folder.write("short.yaml", "include: bar.yaml\ncables: []\ncasting: {min_thickness_m: 0.01}\n");
  const Outcome outcome = run_study(folder,
                                    "program: check_casting\nscene: short.yaml\n"
                                    "parameters: {casting.min_thickness_m: {values: [0.021]}}\n",
                                    "found", "");
  EXPECT_EQ(outcome.exit_status, 1) << outcome.err;
  EXPECT_EQ(cell(contents(folder.path("found/results.csv")), 1, "state"), "not_good");
  EXPECT_NE(outcome.out.find("reason thickness: "), std::string::npos) << outcome.out;
}

TEST(Study, SaysWhichArgumentItsProgramRefused) {
  const SceneFolder folder;
  short_scene(folder);
  const Outcome outcome = run_study(folder,
                                    "program: rollouts\nscene: short.yaml\narguments: [--rollouts, '2']\n"
                                    "parameters: {body.material.density_kg_m3: {values: [1000]}}\n",
                                    "found", "");
  EXPECT_EQ(outcome.exit_status, 1) << outcome.err;
  EXPECT_NE(outcome.out.find("reason rollouts: "), std::string::npos) << outcome.out;
}

TEST(Study, HasTheDistancesOfAPolicy) {
  const SceneFolder folder;
  folder.write("short.yaml", "include: bar.yaml\nbody: {element: linear}\n");
  const Outcome outcome = run_study(folder,
                                    "program: optimise\nscene: short.yaml\n"
                                    "arguments: [--marker, tip, --target, '0.09', '0', '0.005', --iterations, '2']\n"
                                    "parameters: {body.material.density_kg_m3: {values: [1000]}}\n",
                                    "found", "");
  EXPECT_LT(outcome.exit_status, 2) << outcome.err;
  const std::string distance = cell(contents(folder.path("found/results.csv")), 1, "poses[0].final_distance_m");
  EXPECT_GT(std::atof(distance.c_str()), 0.0) << distance << outcome.out;
}

TEST(Study, HasWhereMarkersWereInRollouts) {
  const SceneFolder folder;
  folder.write("short.yaml", "include: bar.yaml\nbody: {element: linear}\n");
  const std::string text =
      "program: rollouts\nscene: short.yaml\nseed: 4\narguments: [--commands, table.csv, --duration, '0.1']\n"
      "parameters: {body.material.youngs_modulus_pa: {values: [2.0e+5, 4.0e+5]}}\n";
  const std::string table = folder.write("table.csv", "rollout,time_s,left\n0,0,0.9\n1,0,0.95\n");
  const Outcome outcome = run_study(folder, text, "found", "");
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  const std::string csv = contents(folder.path("found/results.csv"));
  const Outcome alone = run_program(SOFT_ROBOT_LAB_ROLLOUTS, folder,
                                    folder.path("short.yaml") + " --commands " + table +
                                        " --duration 0.1 --set body.material.youngs_modulus_pa=4e5 --result " +
                                        folder.path("alone.json"));
  ASSERT_EQ(alone.exit_status, 0) << alone.err;
  const Json result = Json::parse(contents(folder.path("alone.json")));
  EXPECT_EQ(result["rollouts"], 2);
  EXPECT_EQ(cell(csv, 2, "markers.tip.mean_m.z"), result["markers"]["tip"]["mean_m"][2].dump());
  EXPECT_EQ(cell(csv, 2, "converged"), "2");
  EXPECT_NE(cell(csv, 1, "markers.tip.least_m.x"), cell(csv, 2, "markers.tip.least_m.x"));
  folder.write("table.csv", "rollout,time_s,left\n0,0,0.8\n");  // another study, though its text is the same
  ASSERT_EQ(run_study(folder, text, "found", "").exit_status, 0);
  EXPECT_EQ(cell(contents(folder.path("found/results.csv")), 2, "rollouts"), "1");
}

TEST(Study, RunsOnHostsThroughARemoteShell) {
  const SceneFolder folder;
  short_scene(folder);
  const std::string shell = folder.write("shell", "#!/bin/sh\necho Welcome to \"$1\"\nshift\nexec sh -c \"$*\"\n");
  std::filesystem::permissions(shell, std::filesystem::perms::owner_all);
  const std::string hosts = folder.write("hosts", "# the lab\none\ntwo 2\n");
  const Outcome remote = run_study(folder, short_study("6"), "remote", "--ssh " + shell + " --hosts " + hosts);
  ASSERT_EQ(remote.exit_status, 0) << remote.err;
  ASSERT_EQ(run_study(folder, short_study("6"), "local", "--workers 1").exit_status, 0);
  EXPECT_EQ(contents(folder.path("remote/results.csv")), contents(folder.path("local/results.csv")));
}

TEST(Study, EndsWhereNoHostAnswers) {
  const SceneFolder folder;
  short_scene(folder);
  const Outcome outcome =
      run_study(folder, short_study("2"), "found", "--ssh false --hosts " + folder.write("hosts", "one\n"));
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE(outcome.err.find("no worker is left; the worker on one ended"), std::string::npos) << outcome.err;
}

TEST(Study, OfTheExamplesAreRead) {
  int count = 0;
  for (const auto& file : std::filesystem::directory_iterator(SOFT_ROBOT_LAB_SOURCE "/config/studies")) {
    EXPECT_NO_THROW(read_study(file.path().string())) << file.path();
    ++count;
  }
  EXPECT_GE(count, 2);
}

TEST(Study, RunsInOneWayAtATime) {
  const SceneFolder folder;
  short_scene(folder);
  const Outcome outcome = run_study(folder, short_study("2"), "found", "--slurm 2 --mpi mpirun");
  EXPECT_EQ(outcome.exit_status, 2);
  EXPECT_NE(outcome.err.find("excludes"), std::string::npos) << outcome.err;
}

TEST(Results, AreNamedByTheirPlaceWithoutTheTimesTheyTook) {
  const auto values = flatten(Json::parse(
      R"({"a": {"p_m": [1, 2, 3], "wall_s": 9}, "list": [4, 5], "things": [{"b": 1}], "words": ["c"], "word": "yes", "none": null})"));
  std::string text;
  for (const auto& [name, value] : values) text += name + "=" + value.dump() + " ";
  EXPECT_EQ(text,
            "a.p_m.x=1 a.p_m.y=2 a.p_m.z=3 list[0]=4 list[1]=5 things[0].b=1 words.count=1 word=\"yes\" none=null ");
}

TEST(Results, OfNumPyBeginAsItsFormatAsks) {
  ResultsTable table;
  table.parameters = {"size_m[0]"};
  table.results = {"on"};
  table.columns = {{true}};
  table.states = table.reasons = {"good"};
  table.tasks = {{"hash", {0.25}, 0}};
  const std::string bytes = results_npy(table);
  EXPECT_EQ(bytes.substr(0, 6), "\x93NUMPY");
  EXPECT_NE(bytes.find("{'descr': [('size_m[0]', '<f8'), ('on', '<f8'), ], 'fortran_order': False, 'shape': (1,), }"),
            std::string::npos);
  EXPECT_EQ((bytes.size() - 16) % 64, 0u);  // two doubles after the aligned header
}

}  // namespace
}  // namespace soft_robot_lab
