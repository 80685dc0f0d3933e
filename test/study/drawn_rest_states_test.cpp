// SPDX-License-Identifier: BSD-3-Clause
// Time as the judge: drawn scenes rest where a slow, damped motion in time leads.
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "study/experiments/drawn_rest_states.h"
#include "study/experiments/drawn_robots.h"
#include "study/experiments/drawn_scenes.h"
#include "study/experiments/judged_scenes.h"

namespace soft_robot_lab {
namespace {

constexpr int kScenesEach = 10;

using Draw = std::function<DrawnScene(std::uint64_t, double)>;

ExperimentContext context_of_tests() {
  ExperimentContext context;
  context.mesher = SOFT_ROBOT_LAB_MESHER;
  context.config_folder = SOFT_ROBOT_LAB_SOURCE "/config";
  return context;
}

// How many are within 0.1 mm, by every method.
int expect_right(const std::vector<int>& seeds, const Draw& draw = draw_scene) {
  const ExperimentContext context = context_of_tests();
  const std::string file = SOFT_ROBOT_LAB_SOURCE "/config/experiments/rest_states.yaml";
  const DrawnSettings settings = read_drawn_settings(YamlNode::load_file(file).child("drawn"));
  int within = 0;
  for (const int seed : seeds) {
    const DrawnMotion scene = [&](double motion_s) { return draw(static_cast<std::uint64_t>(seed), motion_s); };
    bool all_within = true;
    for (const JudgedScene& judged : judge_drawn_scene(scene, settings, context)) {
      EXPECT_TRUE(judged.right(settings.within_m))
          << judged.name << ", " << judged.method << ": " << 1e3 * judged.apart_m << " mm apart; says '" << judged.said
          << "' " << judged.failed;
      all_within = all_within && judged.apart_m <= settings.within_m;
      testing::Test::RecordProperty(judged.method, std::to_string(1e3 * judged.apart_m) + " mm " + judged.said);
    }
    within += all_within ? 1 : 0;
  }
  return within;
}

class DrawnRestStates : public testing::TestWithParam<int> {};

TEST_P(DrawnRestStates, AreThoseThatTimeLeadsToOrSayWhyNot) {
  std::vector<int> seeds(kScenesEach);
  std::iota(seeds.begin(), seeds.end(), kScenesEach * GetParam());
  EXPECT_GE(expect_right(seeds), kScenesEach - 3) << "most have nothing to say";
}

// What rubs rested 0.7 to 1.7 mm from there where it came in one stage.
TEST(DrawnScenes, ThatRubRestWhereASlowWayLeads) { EXPECT_EQ(expect_right({41, 54, 394}), 3); }

// A bar that slipped past a ball, 4.9 mm away, and one past the edge of a box, 6.2 mm, without a word.
TEST(DrawnScenes, ThatSlipPastAnObstacleSaySo) { expect_right({155, 252}); }

// In steps of 0.1 s time led 0.11 and 0.12 mm away from there, in shorter ones it does not.
TEST(DrawnScenes, AreJudgedInShortStepsWhereLongOnesMislead) { EXPECT_EQ(expect_right({174, 321}), 2); }

// A bar that falls over is free to swing aside: at a residual of 1e-6 it was 0.3 mm off, and slept 0.2 mm off.
TEST(DrawnScenes, ThatAreSoftAreAtRest) { EXPECT_EQ(expect_right({124}), 1); }

// Two that a box pushes past their ends rested 3.7 and 11 mm away, one that slips off a ball 2.6 mm.
TEST(DrawnScenes, ThatArePushedAsideRestWhereASlowWayLeads) { EXPECT_EQ(expect_right({33, 117, 312}), 3); }

// Cables that pull a bar past obstacles in one stage left it 0.24 to 3.4 mm away, where it rubs, and 74 mm, where it
// buckles past a post.
TEST(JoinedScenes, RestWhereASlowWayLeads) { EXPECT_EQ(expect_right({12}, draw_joined_scene), 1); }
TEST(JoinedScenes, ThatTakeLongRestWhereASlowWayLeads) { EXPECT_EQ(expect_right({35, 46, 79}, draw_joined_scene), 3); }

// By sweeps two that rub rested 0.13 and 0.55 mm away, one that a rod meets 49 mm, and two did not come to rest.
TEST(DrawnScenes, RestByXpbdToo) {
  EXPECT_EQ(expect_right({5, 18, 22, 31}), 4);
  EXPECT_EQ(expect_right({6}, draw_joined_scene), 1);
}

TEST(DrawnRobots, RestWhereASlowWayLeads) {
  const std::vector<std::string> robots{"robots/spinebot/touching.yaml", "robots/hammerbot/robot.yaml",
                                        "robots/gripper/robot.yaml", "robots/bubblebot/robot.yaml",
                                        "robots/bubblefinger/robot.yaml"};
  const Draw draw = [&](std::uint64_t seed, double motion_s) {
    return draw_robot_scene(seed, motion_s, robots, context_of_tests());
  };
  EXPECT_EQ(expect_right({14, 18, 28}, draw), 3);
}

INSTANTIATE_TEST_SUITE_P(Seeds, DrawnRestStates, testing::Range(0, 4));

TEST(DrawnScenes, AreTheSameForTheSameSeed) {
  EXPECT_EQ(draw_scene(7, 4.0).text(1.0), draw_scene(7, 4.0).text(1.0));
  EXPECT_NE(draw_scene(7, 4.0).text(1.0), draw_scene(8, 4.0).text(1.0));
}

// What had been judged when a run was ended is not judged again, unless the settings changed.
TEST(JudgedScenes, GoOnWhereAnEarlierRunWasEnded) {
  const std::string file = testing::TempDir() + "judged_" + std::to_string(getpid()) + ".jsonl";
  JudgedScene judged;
  judged.name = "7 ball";
  judged.apart_m = 0.25e-3;
  {
    JudgedScenes scenes(file, "one");
    scenes.add(3, {judged, judged});
    scenes.add(5, {judged});
    EXPECT_EQ(scenes.of_earlier_run(), 0);
  }
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 9);  // ended within a line
  const JudgedScenes again(file, "one");
  EXPECT_EQ(again.of_earlier_run(), 1);
  EXPECT_EQ(again.find(5), nullptr);
  ASSERT_NE(again.find(3), nullptr);
  ASSERT_EQ(again.find(3)->size(), 2U);
  EXPECT_EQ(again.find(3)->front().name, "7 ball");
  EXPECT_EQ(again.find(3)->front().apart_m, 0.25e-3);
  EXPECT_EQ(JudgedScenes(file, "other").of_earlier_run(), 0);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace soft_robot_lab
