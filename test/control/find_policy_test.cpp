// SPDX-License-Identifier: BSD-3-Clause
// Tasks of several poses, bounds and limits on a bar with two cables.
#include "soft_robot_lab/control/find_policy.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "cabled_bar.h"

namespace soft_robot_lab {
namespace {

Eigen::Vector3d tip_at(Simulation& simulation, double left, double right) {
  simulation.reset();
  return ForwardModel(simulation, {"tip"}, {"left", "right"}).predict(Eigen::Vector2d(left, right), false).markers_m;
}

PolicyTask reach(const Eigen::Vector3d& target_m) { return {{{{{"tip", target_m, 1.0}}, 2.0, {}}}, {}, 0.0}; }

TEST(FindPolicy, GoesFromPoseToPoseAndLeavesTheModelThere) {
  Simulation simulation = bar();
  const Eigen::Vector3d first_m = tip_at(simulation, 0.95, 1.0), second_m = tip_at(simulation, 1.0, 0.96);
  simulation.reset();
  PolicyTask task = reach(first_m);
  task.poses.push_back({{{"tip", second_m, 1.0}}, 3.0, {}});
  const PolicyAnswer answer = find_policy(simulation, task, {});
  ASSERT_TRUE(answer.success);
  ASSERT_EQ(answer.policy.steps.size(), 2u);
  EXPECT_EQ(answer.policy.names, (std::vector<std::string>{"left", "right"}));
  EXPECT_EQ(answer.policy.steps[1].time_s, 5.0);
  EXPECT_LT((answer.summaries[0].markers_m.col(0) - first_m).norm(), 1e-4);
  EXPECT_LT((simulation.marker_position(simulation.marker_index("tip")) - second_m).norm(), 1e-4);
}

TEST(FindPolicy, ReplaysToWhereItSaid) {
  Simulation simulation = bar();
  PolicyTask task = reach(tip_at(simulation, 0.93, 1.0));
  simulation.reset();
  const PolicyAnswer answer = find_policy(simulation, task, {});
  simulation.reset();
  const auto places = replay(simulation, answer.policy, {"tip"});
  EXPECT_LT((places.back().col(0) - answer.summaries.back().markers_m.col(0)).norm(), 1e-6);
}

TEST(FindPolicy, PullsInTheOrderAskedFor) {
  Simulation simulation = bar();
  PolicyTask task = reach(tip_at(simulation, 0.95, 0.98));
  simulation.reset();
  task.poses.insert(task.poses.begin(), task.poses.front());
  task.poses[0].actuators = {"right"};
  task.poses[1].actuators = {"left"};
  const PolicyAnswer answer = find_policy(simulation, task, {});
  ASSERT_EQ(answer.policy.steps.size(), 2u);
  EXPECT_EQ(answer.policy.steps[0].values[0], 1.0);
  EXPECT_EQ(answer.policy.steps[1].values[1], answer.policy.steps[0].values[1]);
  EXPECT_LT(answer.policy.steps[1].values[0], 1.0);
}

// All but the first pose are there already, and no iteration says how far it is.
TEST(FindPolicy, EndsALongPathAtOnceWhereTheSimulationIsInterrupted) {
  Simulation simulation = bar();
  PolicyTask task = reach(tip_at(simulation, 0.95, 1.0));
  simulation.reset();
  task.poses.resize(1000, task.poses.front());
  int asked = 0;
  constexpr int patience = 4000;
  simulation.set_interrupt([&] { return ++asked > patience; });
  const PolicyAnswer answer = find_policy(simulation, task, {});
  EXPECT_FALSE(answer.success);
  EXPECT_GT(answer.summaries.size(), 2u);
  EXPECT_LT(answer.summaries.size(), 1000u);
  const auto found = std::count_if(answer.summaries.begin(), answer.summaries.end(),
                                   [](const auto& summary) { return summary.usable; });
  EXPECT_EQ(answer.policy.steps.size(), static_cast<std::size_t>(found)) << "what was found counts";
  EXPECT_LT(asked, patience + 20);
}

TEST(FindPolicy, IsCancelledWithinItsFirstRestState) {
  for (const std::string& method : optimiser_methods()) {
    Simulation simulation = bar();
    const PolicyTask task = reach(tip_at(simulation, 0.95, 1.0));
    simulation.reset();
    int asked = 0;
    simulation.set_interrupt([&] { return ++asked > 3; });
    OptimiserOptions options;
    options.method = method;
    const PolicyAnswer answer = find_policy(simulation, task, options);
    EXPECT_FALSE(answer.success && !answer.summaries.front().usable);
    EXPECT_EQ(answer.summaries.front().stop_reason, "cancelled") << method;
    EXPECT_LT(asked, 40) << method;
  }
}

TEST(FindPolicy, RefusesLimitsThatNameAnActuatorTwice) {
  Simulation simulation = bar();
  PolicyTask task = reach({0.1, 0, 0});
  task.bounds = {{"left", 0.9, 1.0}, {"right", 0.9, 1.0}, {"left", 0.8, 1.0}};
  try {
    find_policy(simulation, task, {});
    FAIL() << "taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("'left' is named twice"), std::string::npos) << error.what();
  }
}

// Each would have been met halfway, without a word.
TEST(FindPolicy, RefusesAPoseThatNamesAMarkerOrAnActuatorTwice) {
  Simulation simulation = bar();
  const auto refusal = [&](const PolicyTask& task) -> std::string {
    try {
      find_policy(simulation, task, {});
      return "";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  PolicyTask task = reach({0.1, 0, 0});
  task.poses[0].goals.push_back(task.poses[0].goals[0]);
  task.poses[0].goals[1].target_m.y() += 0.01;
  EXPECT_NE(refusal(task).find("goals: '" + task.poses[0].goals[0].marker + "' is named twice"), std::string::npos);
  task = reach({0.1, 0, 0});
  task.poses[0].actuators = {"left", "left"};
  EXPECT_NE(refusal(task).find("actuators: 'left' is named twice"), std::string::npos);
}

TEST(FindPolicy, NeverMovesACommandFasterThanItsRate) {
  Simulation simulation = bar();
  PolicyTask task = reach(tip_at(simulation, 0.9, 1.0));
  simulation.reset();
  task.bounds.push_back({"left", 0.7, 1.0});
  task.bounds.back().max_rate_per_s = 0.02;
  const PolicyAnswer answer = find_policy(simulation, task, {});
  ASSERT_TRUE(answer.success);
  EXPECT_GE(answer.policy.steps[0].values[0], 0.96 - 1e-12);
  ASSERT_FALSE(answer.summaries[0].active_limits.empty());
  EXPECT_NE(answer.summaries[0].active_limits[0].find("rate"), std::string::npos)
      << answer.summaries[0].active_limits[0];
}

TEST(FindPolicy, KeepsTheTensionBelowItsLimitAtEveryIterate) {
  Simulation simulation = bar();
  const Eigen::Vector3d target_m = tip_at(simulation, 0.9, 1.0);
  const double free_n = *simulation.actuator_state(0).tension_n;
  simulation.reset();
  PolicyTask task = reach(target_m);
  const double limit_n = 0.5 * free_n;
  task.bounds.push_back({"left", 0.7, 1.0, limit_n});
  const PolicyAnswer answer = find_policy(simulation, task, {});
  ASSERT_TRUE(answer.success);
  const double tension_n = *simulation.actuator_state(simulation.actuator_index("left")).tension_n;
  EXPECT_LE(tension_n, limit_n * (1.0 + 1e-6));
  EXPECT_GT(tension_n, 0.97 * limit_n);
}

TEST(FindPolicy, KeepsTheBestWhenItIsCancelled) {
  Simulation simulation = bar();
  PolicyTask task = reach(tip_at(simulation, 0.9, 1.0));
  simulation.reset();
  task.poses.push_back(task.poses.front());
  const PolicyAnswer answer = find_policy(
      simulation, task, {}, [](size_t, const auto&, const OptimisationProgress& now) { return now.iteration < 2; });
  EXPECT_FALSE(answer.success);
  ASSERT_EQ(answer.summaries.size(), 1u);
  EXPECT_EQ(answer.summaries[0].stop_reason, "cancelled");
  EXPECT_EQ(answer.policy.steps.size(), 1u);
  EXPECT_LT(answer.summaries[0].final_distance_m, answer.summaries[0].initial_distance_m);
}

// Up to where targets, weights and efforts are taken, all that comes out is a number.
TEST(FindPolicy, AnswersWithNumbersUpToItsLimits) {
  Simulation simulation = bar();
  PolicyTask task = reach({1000.0, -1000.0, 1000.0});
  task.poses[0].goals[0].weight = 1e6;
  task.poses[0].goals.push_back({"middle", {0.05, 0.0, 0.0}, 1e-300});
  task.poses[0].duration_s = 1e6;
  task.effort_m = 1000.0;
  const PolicyAnswer answer = find_policy(simulation, task, {});
  ASSERT_EQ(answer.summaries.size(), 1u);
  const OptimisationSummary& summary = answer.summaries[0];
  EXPECT_NEAR(summary.final_distance_m, 1000.0 * std::sqrt(3.0), 1.0) << summary.stop_reason;
  EXPECT_TRUE(summary.commands.allFinite() && summary.markers_m.allFinite());
  for (const TimedCommandValues& step : answer.policy.steps)
    for (const double value : step.values) EXPECT_TRUE(std::isfinite(value));
}

// Whoever asks for more finds what to change.
TEST(CommandLimits, NameTheKeyThatMovesThem) {
  Simulation simulation = bar();
  CommandPolicy policy{{"left"}, {{1.0, {0.4}}}};
  const auto refusal = [](const auto& action) -> std::string {
    try {
      action();
      return "taken";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  const std::string hint = "; min_contraction of 'left' moves that limit";
  EXPECT_EQ(refusal([&] { simulation.set_command("left", 0.4); }),
            "command of actuator 'left': 0.4 is out of range [0.5, 1.5]" + hint);
  const auto judge = [&] { validate(policy, limits_of(simulation)); };
  EXPECT_EQ(refusal(judge), "policy.steps[0].values: 0.4 for 'left' is not in [0.5, 1.5]" + hint);
  policy.steps[0].values[0] = 1.6;
  EXPECT_EQ(refusal(judge), "policy.steps[0].values: 1.6 for 'left' is not in [0.5, 1.5]") << "no key moves it";
}

TEST(FindPolicy, RefusesWhatItCannotDo) {
  struct Case {
    const char* words;
    void (*spoil)(PolicyTask&);
  };
  const Case cases[] = {
      {"poses: empty", [](PolicyTask& t) { t.poses.clear(); }},
      {"goals: empty", [](PolicyTask& t) { t.poses[0].goals.clear(); }},
      {"unknown marker 'tail'", [](PolicyTask& t) { t.poses[0].goals[0].marker = "tail"; }},
      {"target of tip", [](PolicyTask& t) { t.poses[0].goals[0].target_m.x() = NAN; }},
      {"is not within 1000 m", [](PolicyTask& t) { t.poses[0].goals[0].target_m.y() = -1000.1; }},
      {"is not within 1000 m", [](PolicyTask& t) { t.poses[0].goals[0].target_m.z() = 1e300; }},
      {"weight of tip: 1e+300 is not in (0, 1e+06]", [](PolicyTask& t) { t.poses[0].goals[0].weight = 1e300; }},
      {"duration_s: 1e+300 is not in (0, 1e+06]", [](PolicyTask& t) { t.poses[0].duration_s = 1e300; }},
      {"effort_m: 1e+300 is not in [0, 1000]", [](PolicyTask& t) { t.effort_m = 1e300; }},
      {"weight of tip: -1", [](PolicyTask& t) { t.poses[0].goals[0].weight = -1.0; }},
      {"duration_s: 0", [](PolicyTask& t) { t.poses[0].duration_s = 0.0; }},
      {"unknown actuator 'top'", [](PolicyTask& t) { t.poses[0].actuators = {"top"}; }},
      {"limits: [-1, 1] for 'left' is not an interval within [0.5, 1.5]; min_contraction of 'left' moves that limit",
       [](PolicyTask& t) {
         t.bounds.push_back({"left", -1.0, 1.0});
       }},
      {"max_tension_n 0",
       [](PolicyTask& t) {
         t.bounds.push_back({"left", 0.8, 1.0, 0.0});
       }},
      {"max_rate_per_s -1",
       [](PolicyTask& t) {
         t.bounds.push_back({"left", 0.8, 1.0, 1.0, -1.0});
       }},
      {"cannot come within",
       [](PolicyTask& t) {
         t.bounds.push_back({"left", 0.8, 0.9, 1.0, 0.01});
       }},
      {"effort_m: -1", [](PolicyTask& t) { t.effort_m = -1.0; }},
  };
  Simulation simulation = bar();
  for (const Case& refused : cases) {
    PolicyTask task = reach({0.1, 0.0, 0.0});
    refused.spoil(task);
    try {
      find_policy(simulation, task, {});
      ADD_FAILURE() << "accepted: " << refused.words;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(refused.words), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
