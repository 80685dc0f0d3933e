// SPDX-License-Identifier: BSD-3-Clause
// Many runs of one scene: the same numbers however many threads there are, and what goes in and out of the program.
#include <atomic>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "robot/rollouts/npz.h"
#include "robot/rollouts/rollout_commands.h"
#include "robot/rollouts/rollout_file.h"
#include "robot/scene/cabled_bar.h"
#include "run_program.h"
#include "soft_robot_lab/robot/rollouts/batch.h"

namespace soft_robot_lab {
namespace {

const std::string kNewton = "solver: {time_step_s: 0.05}\n";
const std::string kReduced =
    "solver: {time_step_s: 0.05, method: reduced, tolerance_m: 3.0e-4, commands: {left: [0.9, 1]}}\n";

class RolloutsOfABar : public testing::Test {
 protected:
  static void SetUpTestSuite() { folder_ = new CabledBar; }
  static void TearDownTestSuite() { delete folder_; }

  static Scene load(const std::string& solver) { return folder_->load(solver); }

  static RolloutPlan random_plan(const Scene& scene, int rollouts) {
    const CommandBox box{{0.9}, {1.0}};
    return {1.0, 0.0, random_commands({box, rollouts, 1.0, 0.25, 3}, *scene.simulation->model())};
  }

  static Outcome run(const std::string& arguments) { return run_program(SOFT_ROBOT_LAB_ROLLOUTS, *folder_, arguments); }

  static CabledBar* folder_;
};
CabledBar* RolloutsOfABar::folder_ = nullptr;

void expect_equal(const std::vector<RunReport>& one, const std::vector<RunReport>& other) {
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].trajectory.time_s, other[i].trajectory.time_s);
    EXPECT_EQ(one[i].trajectory.markers_m, other[i].trajectory.markers_m) << i;
    EXPECT_EQ(one[i].trajectory.commands, other[i].trajectory.commands);
    EXPECT_EQ(one[i].left_reduced, other[i].left_reduced);
  }
}

TEST_F(RolloutsOfABar, AreTheSameToTheLastBitInSeveralThreads) {
  for (const std::string& solver : {kNewton, kReduced}) {
    SCOPED_TRACE(solver);
    const Scene scene = load(solver);
    const RolloutPlan plan = random_plan(scene, 7);
    const RolloutBatch batch(scene);
    const std::vector<RunReport> alone = batch.run(plan, 1), together = batch.run(plan, 3);
    expect_equal(alone, together);
    EXPECT_NE(alone[0].trajectory.markers_m.back(), alone[1].trajectory.markers_m.back());
    EXPECT_EQ(alone[0].trajectory.markers_m.size(), 21u);
  }
}

TEST_F(RolloutsOfABar, DoNotHangOnThoseBefore) {
  for (const std::string& solver : {kNewton, kReduced}) {
    SCOPED_TRACE(solver);
    const Scene scene = load(solver);
    RolloutPlan plan = random_plan(scene, 3);
    const std::vector<RunReport> all = RolloutBatch(scene).run(plan, 1);
    plan.rollouts = {plan.rollouts[2]};
    expect_equal(RolloutBatch(scene).run(plan, 1), {all[2]});
  }
}

TEST_F(RolloutsOfABar, OfAReducedModelAreThoseOfARunOfTheScene) {
  const Scene scene = load(kReduced);
  const RolloutPlan plan{1.0, 0.0, {{{0.0, {{"left", 0.92}}}, {0.5, {{"left", 0.97}}}}}};
  Scene one =
      load(kReduced +
           "run: {mode: dynamic, duration_s: 1, commands: [{time_s: 0, left: 0.92}, {time_s: 0.5, left: 0.97}]}\n");
  expect_equal(RolloutBatch(scene).run(plan, 2), {run_scene(one)});
}

TEST_F(RolloutsOfABar, GoOnByNewtonBeyondWhatWasTrainedAndSaySo) {
  const Scene scene = load(kReduced);
  RolloutPlan plan{0.5, 0.0, {{{0.0, {{"left", 0.95}}}}, {{0.0, {{"left", 0.95}}}, {0.25, {{"left", 0.8}}}}}};
  plan.rollouts.push_back(plan.rollouts[0]);
  const std::vector<RunReport> reports = RolloutBatch(scene).run(plan, 1);
  EXPECT_FALSE(reports[0].left_reduced);
  EXPECT_TRUE(reports[1].left_reduced);
  ASSERT_FALSE(reports[1].solve.warnings.empty());
  EXPECT_EQ(reports[1].solve.warnings[0].kind, "outside_training");
  EXPECT_FALSE(reports[2].left_reduced);
  EXPECT_EQ(reports[2].trajectory.markers_m, reports[0].trajectory.markers_m);
}

TEST_F(RolloutsOfABar, StopWhereTheCallerWantsNoMore) {
  const Scene scene = load(kNewton);
  const std::vector<RunReport> reports =
      RolloutBatch(scene).run(random_plan(scene, 5), 1, [](std::size_t ended) { return ended < 2; });
  EXPECT_FALSE(reports[1].trajectory.time_s.empty());
  EXPECT_TRUE(reports[2].trajectory.time_s.empty());
}

TEST_F(RolloutsOfABar, EndWithinAStepAndLeaveOutWhatIsNotWhole) {
  const Scene scene = load(kNewton);
  const RolloutPlan plan = random_plan(scene, 5);
  for (const int threads : {1, 3}) {
    std::atomic<int> asked{0};
    const std::vector<RunReport> reports = RolloutBatch(scene).run(plan, threads, {}, [&] { return ++asked > 30; });
    ASSERT_EQ(reports.size(), plan.rollouts.size());
    EXPECT_TRUE(reports.back().trajectory.time_s.empty());
    for (const RunReport& report : reports) EXPECT_TRUE(report.solve.converged || report.trajectory.time_s.empty());
    EXPECT_LT(asked, 30 + 10 * threads);
  }
}

TEST_F(RolloutsOfABar, RefuseBadPlansBeforeAnythingMoves) {
  const Scene scene = load(kNewton);
  const auto refusal = [&](RolloutPlan plan, int threads) -> std::string {
    try {
      RolloutBatch(scene).run(plan, threads);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const RolloutPlan good = random_plan(scene, 1);
  RolloutPlan plan = good;
  EXPECT_NE(refusal(plan, 0).find("threads: 0"), std::string::npos);
  plan.duration_s = -1.0;
  EXPECT_NE(refusal(plan, 1).find("duration_s: -1"), std::string::npos);
  plan = good;
  plan.rollouts[0][1].commands[0].second = 7.0;
  EXPECT_NE(refusal(plan, 1).find("left"), std::string::npos);
  plan = good;
  plan.rollouts[0][1].time_s = -0.5;
  EXPECT_NE(refusal(plan, 1).find("time_s: -0.5"), std::string::npos);
}

TEST_F(RolloutsOfABar, RandomCommandsOfFewAreTheFirstOfMany) {
  const Scene scene = load(kNewton);
  const CommandBox box{{0.9}, {1.0}};
  const auto draw = [&](int rollouts, unsigned seed) {
    return random_commands({box, rollouts, 1.0, 0.3, seed}, *scene.simulation->model());
  };
  const std::vector<RolloutCommands> few = draw(2, 1), many = draw(5, 1);
  ASSERT_EQ(few[1].size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(few[1][k].commands, many[1][k].commands);
    EXPECT_GE(few[1][k].commands[0].second, 0.9);
    EXPECT_LE(few[1][k].commands[0].second, 1.0);
  }
  EXPECT_NE(few[0][0].commands, few[1][0].commands);
  EXPECT_NE(few[0][0].commands, draw(2, 2)[0][0].commands);
}

TEST_F(RolloutsOfABar, ReadTheSameCommandsFromATableAndFromArrays) {
  const Scene scene = load(kNewton);
  const Model& model = *scene.simulation->model();
  const std::string table =
      folder_->write("c.csv", "\xef\xbb\xbfrollout,time_s,left\n0,0,0.95\n0,0.5,0.9\n1,0,1\n1,0.5,0.93\r\n");
  const std::string arrays = folder_->path("c.npz");
  std::ofstream(arrays, std::ios::binary) << npz({numbers_array("left", {2, 2}, {0.95, 0.9, 1.0, 0.93})});
  const std::vector<RolloutCommands> a = read_commands_file(table, 0.5, model),
                                     b = read_commands_file(arrays, 0.5, model);
  ASSERT_EQ(a.size(), 2u);
  ASSERT_EQ(b.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(a[i][k].time_s, b[i][k].time_s);
      EXPECT_EQ(a[i][k].commands, b[i][k].commands);
    }
  EXPECT_EQ(a[1][1].commands[0].second, 0.93);
}

TEST_F(RolloutsOfABar, NameWhatIsWrongInATable) {
  const Scene scene = load(kNewton);
  const struct {
    std::string text, words;
  } cases[] = {
      {"", "is empty"},
      {"rollout,time_s,third\n", "third"},
      {"rollout,time_s,left\n0,0\n", "bad.csv:2: 2 cells, must be 3"},
      {"rollout,time_s,left\n0,0,much\n", "bad.csv:2: left: 'much'"},
      {"rollout,time_s,left\n0,0,0.95\n0,1,nan\n", "bad.csv:3: left"},
      {"rollout,time_s,left\n0,0,9\n", "bad.csv:2: "},
      {"rollout,time_s,left\n1,0,0.95\n", "bad.csv:2: rollout 1 comes after -1"},
      {"rollout,time_s,left\n0,0,1\n1,0,1\n0,1,1\n", "bad.csv:4: rollout 0 comes after 1"},
      {"rollout,time_s,left\n0,0,1\n\n0,1,1\n0,0.5,1\n", "bad.csv:5: time_s: 0.5 comes after 1"},
      {"rollout,time_s,left\n0,-1,1\n", "bad.csv:2: time_s: -1 comes after 0"},
      {"rollout;time_s;left\n0;0;1\n", "bad.csv:1: its cells are parted by ';', must be by ','"},
      {"rollout\ttime_s\tleft\n0\t0\t1\n", "bad.csv:1: its cells are parted by tabs, must be by ','"},
      {"rollout,time_s,left,left\n0,0,1,0.9\n", "bad.csv:1: has the column 'left' twice"},
      {"rollout,left\n0,1\n", "bad.csv:1: has no column 'time_s'"},
      {"time_s,left\n0,1\n", "bad.csv:1: has no column 'rollout'"},
      {"rollout,time_s,third\n0,0,1\n", "bad.csv:1: "},
      {"\xff\xfer", "bad.csv:1: is text in UTF-16"},
      {"rollout,time_s,left\n0,1e7,1\n", "bad.csv:2: time_s: 10000000 is not in [-1000000, 1000000]"},
      {"rollout,time_s,left\n0,0,1" + std::string(1, '\0') + "\n", "bad.csv:2: left: '1?' is not a finite number"},
  };
  for (const auto& one : cases) {
    try {
      read_commands_file(folder_->write("bad.csv", one.text), 0.5, *scene.simulation->model());
      ADD_FAILURE() << one.text;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(one.words), std::string::npos) << error.what();
    }
  }
}

TEST_F(RolloutsOfABar, RefuseFilesWithoutRolloutsOrWithTooMany) {
  const Scene scene = load(kNewton);
  const auto refusal = [&](const std::string& name, const std::string& text, double hold_s = 0.5) -> std::string {
    try {
      read_commands_file(folder_->write(name, text), hold_s, *scene.simulation->model());
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto of_shape = [](std::vector<std::size_t> shape) {
    return npz({numbers_array("left", std::move(shape), {})});
  };
  EXPECT_NE(refusal("a.npz", of_shape({0, 3})).find("left: 0 rollouts are not in [1, 1000000]"), std::string::npos);
  EXPECT_NE(refusal("a.npz", of_shape({3, 0})).find("left: its rollouts hold no commands"), std::string::npos);
  EXPECT_NE(refusal("a.npz", of_shape({2000000, 0})).find("2000000 rollouts are not in"), std::string::npos)
      << refusal("a.npz", of_shape({2000000, 0}));
  EXPECT_NE(refusal("a.npz", npz({})).find("0 rollouts"), std::string::npos);
  EXPECT_NE(refusal("a.npz", npz({numbers_array("left", {1, 1}, {0.95})}), 1e300).find("hold_s"), std::string::npos);
  EXPECT_NE(refusal("a.csv", "rollout,time_s,left\n").find("0 rollouts"), std::string::npos);
  RandomCommands random{command_box(scene), 1000000, 10.0, 1e-3, 1};
  EXPECT_THROW(random_commands(random, *scene.simulation->model()), std::invalid_argument);
}

TEST_F(RolloutsOfABar, ProgramWritesWhatPythonUnpacks) {
  folder_->write("robot.yaml", "include: coarse.yaml\n" + kNewton);
  const std::string output = folder_->path("data.npz");
  const Outcome outcome =
      run(folder_->path("robot.yaml") +
          " --random 3 --duration 0.5 --hold 0.25 --range left 0.9 1 --threads 2 --output " + output);
  ASSERT_EQ(outcome.exit_status, 0) << outcome.err;
  const std::vector<NpzArray> arrays = read_npz(contents(output));
  ASSERT_EQ(arrays.size(), 8u);
  EXPECT_EQ(arrays[3].name, "commands");
  EXPECT_EQ(arrays[3].shape, (std::vector<std::size_t>{3, 11, 1}));
  EXPECT_EQ(arrays[5].shape, (std::vector<std::size_t>{3, 11, 2, 3}));
  EXPECT_EQ(arrays[6].bytes, std::string(3, '\1'));
  // Python's own reader of archives checks names, sizes and sums; NumPy is built upon it.
  const std::string script = folder_->write("check.py", R"(import ast, struct, sys, zipfile
archive = zipfile.ZipFile(sys.argv[1])
assert archive.testzip() is None
data = archive.read("markers_m.npy")
assert data[:8] == b"\x93NUMPY\x01\x00"
size = struct.unpack("<H", data[8:10])[0]
assert (10 + size) % 64 == 0
header = ast.literal_eval(data[10 : 10 + size].decode())
assert header == {"descr": "<f8", "fortran_order": False, "shape": (3, 11, 2, 3)}, header
assert len(data) == 10 + size + 8 * 3 * 11 * 2 * 3
)");
  EXPECT_EQ(std::system((std::string(SOFT_ROBOT_LAB_PYTHON) + " " + script + " " + output).c_str()), 0);
}

TEST_F(RolloutsOfABar, ProgramNamesWrongArguments) {
  folder_->write("robot.yaml", "include: coarse.yaml\n" + kNewton);
  const std::string robot = folder_->path("robot.yaml"), to = " --output " + folder_->path("x.npz");
  const struct {
    std::string arguments, words;
  } cases[] = {{"", "--commands"},
               {" --commands none.txt", ".csv or .npz"},
               {" --random 1 --range left 0.9 7", "left"},
               {" --random -1", "--random: Value -1 not in range 1 to 1000000"}};
  for (const auto& one : cases) {
    const Outcome outcome = run(robot + to + one.arguments);
    EXPECT_EQ(outcome.exit_status, 2);
    EXPECT_NE(outcome.err.find(one.words), std::string::npos) << outcome.err;
  }
  // What can be said before anything is read.
  EXPECT_NE(run("missing.yaml --random 1 --output data.txt").err.find("--output: data.txt must end in .npz"),
            std::string::npos);
  EXPECT_NE(run("missing.yaml --commands a.txt --output a.npz").err.find("a.txt: must end in .csv or .npz"),
            std::string::npos);
}

}  // namespace
}  // namespace soft_robot_lab
