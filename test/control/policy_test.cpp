// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/policy.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

TimedCommandValues step(double time_s, const std::vector<double>& values) {
  TimedCommandValues result;
  result.time_s = time_s;
  result.values = values;
  return result;
}

CommandPolicy two_steps() {
  CommandPolicy policy;
  policy.names = {"left", "right"};
  policy.steps = {step(1.0, {0.8, 1.0}), step(3.0, {0.9, 0.7})};
  return policy;
}

const CommandRange limit{{1.0, 0.7, 1.0, "1"}};
const CommandLimitsByName limits = {{"left", limit}, {"right", limit}};

TEST(PolicyPlayer, MovesLinearlyFromTheStartThroughEachStepAndStays) {
  const PolicyPlayer player(two_steps(), {1.0, 0.9});
  EXPECT_EQ(player.values_at(0.0), (std::vector<double>{1.0, 0.9}));
  EXPECT_NEAR(player.values_at(0.5)[0], 0.9, 1e-12);
  EXPECT_NEAR(player.values_at(0.5)[1], 0.95, 1e-12);
  EXPECT_NEAR(player.values_at(1.0)[0], 0.8, 1e-12);
  EXPECT_NEAR(player.values_at(2.0)[1], 0.85, 1e-12);
  EXPECT_EQ(player.values_at(3.0), (std::vector<double>{0.9, 0.7}));
  EXPECT_EQ(player.values_at(99.0), (std::vector<double>{0.9, 0.7}));
}

TEST(PolicyPlayer, JumpsAtAStepOfTimeZero) {
  CommandPolicy policy = two_steps();
  policy.steps = {step(0.0, {0.75, 0.75})};
  EXPECT_EQ(PolicyPlayer(policy, {1.0, 1.0}).values_at(0.0), (std::vector<double>{0.75, 0.75}));
}

TEST(PolicyValidation, TakesAGoodPolicy) { EXPECT_NO_THROW(validate(two_steps(), limits)); }

TEST(PolicyValidation, RefusesEachWrongField) {
  struct Case {
    const char* words;  // expected in the message
    void (*spoil)(CommandPolicy&);
  };
  const Case cases[] = {
      {"policy.names: empty", [](CommandPolicy& p) { p.names.clear(); }},
      {"'tail' is not one of left, right", [](CommandPolicy& p) { p.names[0] = "tail"; }},
      {"'right' is given twice", [](CommandPolicy& p) { p.names[0] = "right"; }},
      {"policy.steps: empty", [](CommandPolicy& p) { p.steps.clear(); }},
      {"policy.steps[0].time_s: -1 is not in [0, 1e+06]", [](CommandPolicy& p) { p.steps[0].time_s = -1.0; }},
      {"policy.steps[0].time_s: nan", [](CommandPolicy& p) { p.steps[0].time_s = NAN; }},
      {"policy.steps[1].time_s: 0.5 is not in [1, 1e+06]", [](CommandPolicy& p) { p.steps[1].time_s = 0.5; }},
      {"policy.steps[1].time_s: 1e+308 is not in [1, 1e+06]", [](CommandPolicy& p) { p.steps[1].time_s = 1e308; }},
      {"policy.steps[1].values: 1 values for 2 names", [](CommandPolicy& p) { p.steps[1].values.pop_back(); }},
      {"0.5 for 'left' is not in [0.7, 1]", [](CommandPolicy& p) { p.steps[0].values[0] = 0.5; }},
      {"nan for 'right' is not in [0.7, 1]", [](CommandPolicy& p) { p.steps[0].values[1] = NAN; }},
  };
  for (const Case& wrong : cases) {
    CommandPolicy policy = two_steps();
    wrong.spoil(policy);
    try {
      validate(policy, limits);
      ADD_FAILURE() << "took: " << wrong.words;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(wrong.words), std::string::npos) << error.what();
    }
  }
}

TEST(Policy, BelongsToItsRobot) {
  CommandPolicy policy = two_steps();
  require_robot(policy, "spinebot");
  policy.robot = "gripper";
  require_robot(policy, "gripper");
  try {
    require_robot(policy, "spinebot");
    ADD_FAILURE() << "it is the gripper's";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(
        error.what(),
        "policy.robot: this policy is for 'gripper', and 'spinebot' runs; leave `robot` out to play it all the same");
  }
}

std::string written(const std::string& text) {
  const std::string path = testing::TempDir() + "policy_test.yaml";
  std::ofstream(path) << text;
  return path;
}

TEST(PolicyFile, ReadsWhatItWroteToTheLastDigit) {
  CommandPolicy policy = two_steps();
  policy.steps[0].values[0] = 0.1 + 0.7;
  EXPECT_EQ(load_policy(written(policy_yaml(policy))).robot, "");
  policy.robot = "it's: mine";
  const CommandPolicy read = load_policy(written(policy_yaml(policy)));
  EXPECT_EQ(read.robot, policy.robot);
  EXPECT_EQ(read.names, policy.names);
  ASSERT_EQ(read.steps.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read.steps[i].time_s, policy.steps[i].time_s);
    EXPECT_EQ(read.steps[i].values, policy.steps[i].values);
  }
}

TEST(PolicyFile, IsReadStrictly) {
  const std::pair<const char*, const char*> cases[] = {
      {"names: [left]\nsteps: [{time_s: 1, values: [0.9], speed: 2}]\n", "speed"},
      {"names: [left]\nsteps: [{time_s: -1, values: [0.9]}]\n", "time_s"},
      {"names: [left]\nsteps: [{time_s: 1, values: [fast]}]\n", "values"},
      {"names: [left]\n", "steps"},
      {"steps: []\n", "names"},
  };
  for (const auto& [text, words] : cases) {
    try {
      load_policy(written(text));
      ADD_FAILURE() << "accepted: " << text;
    } catch (const SettingsError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
