// SPDX-License-Identifier: BSD-3-Clause
// What becomes of policies on a robot that is not its model: closed loop, and faults during execution.
#include <cmath>
#include <csignal>
#include <future>
#include <memory>
#include <regex>
#include <string>

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/OptimisePolicy.h>

#include "process_of.h"
#include "session_ears.h"
#include "stub_robot.h"

namespace soft_robot_lab {
namespace {

const std::string scenes = SOFT_ROBOT_LAB_SOURCE "/test/data/scenes/";
std::unique_ptr<StubRobot> robot;

OptimisePolicy::Request reach(const Eigen::Vector3d& target_m) {
  OptimisePolicy::Request request;
  request.method = "gauss_newton";
  request.marker = "tip";
  request.target = to_message(target_m);
  return request;
}

PolicyPose goal_at(double x_m, double y_m, double z_m) {
  PolicyPose goal;
  goal.markers = {"tip"};
  goal.targets = {to_message(Eigen::Vector3d(x_m, y_m, z_m))};
  return goal;
}

ExecutePolicy::Request pull(double right, double time_s) {
  ExecutePolicy::Request request;
  request.policy.names = {"left", "right"};
  request.policy.steps.resize(1);
  request.policy.steps[0].time_s = time_s;
  request.policy.steps[0].values = {1.0, right};
  request.wait_until_rest = true;
  request.time_limit_s = 1.0e4;
  return request;
}

class Controller : public testing::Test {
 protected:
  static void SetUpTestSuite() { robot = std::make_unique<StubRobot>(scenes); }
  static void TearDownTestSuite() { robot.reset(); }
  void SetUp() override {
    robot->tip_seen = robot->middle_seen = true;
    robot->stalled = false;
    robot->knock_m = 0.0;
    // Back to rest, once the controller has heard that all is well again.
    ASSERT_TRUE(spin_until([this] { return execute(pull(1.0, 1.0)).success; }, 30.0));
  }

  ExecutePolicy::Response execute(const ExecutePolicy::Request& request) {
    return ask<ExecutePolicy>(node_, topics::execute_policy, request);
  }
  std::future<ExecutePolicy::Response> execute_meanwhile(const ExecutePolicy::Request& request) {
    return std::async(std::launch::async, [this, request] { return execute(request); });
  }
  // Until a policy that pulls it plays: on a busy machine commands of the one before may still be heard.
  void wait_until_pulled() {
    ASSERT_TRUE(spin_until([] { return robot->right < 1.0; }, 30.0));
  }
  void expect_commands_are_held() {
    const double from_s = ros::Time::now().toSec();
    ros::WallDuration(0.3).sleep();  // one and a half seconds of the session
    EXPECT_LE(robot->last_command_s, from_s);
  }

  ros::NodeHandle node_;
};

TEST_F(Controller, CorrectsByWhatTheMarkersShow) {
  const OptimisePolicy::Request search = reach({0.02, 0.0, -0.093});
  const auto found = ask<OptimisePolicy>(node_, topics::optimise_policy, search);
  ASSERT_TRUE(found.success) << found.message;
  ExecutePolicy::Request request = pull(1.0, 1.0);
  request.policy = found.policy;
  const auto replayed = execute(request);
  ASSERT_TRUE(replayed.success) << replayed.message;
  EXPECT_EQ(replayed.final_distance_m, -1.0);
  const Eigen::Vector3d target_m = from_message(search.target, "target");
  const double replayed_m = (position_of(replayed.measured, "tip") - target_m).norm();

  request.closed_loop = true;  // on the goal of the policy found
  const auto corrected = execute(request);
  ASSERT_TRUE(corrected.success) << corrected.message;
  EXPECT_EQ(corrected.message, "settled");
  EXPECT_GT(corrected.corrections, 0);
  EXPECT_LT(corrected.final_distance_m, replayed_m);
  EXPECT_NEAR(corrected.final_distance_m, (position_of(corrected.measured, "tip") - target_m).norm(), 1e-6);
}

TEST_F(Controller, GoesOnWithTheMarkersThatAreStillSeen) {
  ExecutePolicy::Request request = pull(0.9, 1.0);
  request.closed_loop = true;
  request.goal = goal_at(0.02, 0.0, -0.093);
  auto answer = execute_meanwhile(request);
  wait_until_pulled();
  robot->middle_seen = false;
  const auto corrected = answer.get();
  EXPECT_TRUE(corrected.success) << corrected.message;
  EXPECT_EQ(corrected.message, "settled");
}

TEST_F(Controller, HoldsWhenTrackingIsLost) {
  ExecutePolicy::Request request = pull(0.9, 1.0);
  request.closed_loop = true;
  request.goal = goal_at(0.02, 0.0, -0.093);
  auto answer = execute_meanwhile(request);
  wait_until_pulled();
  robot->tip_seen = robot->middle_seen = false;
  const auto stopped = answer.get();
  EXPECT_FALSE(stopped.success);
  EXPECT_NE(stopped.message.find("tracking lost"), std::string::npos) << stopped.message;
  expect_commands_are_held();
}

TEST_F(Controller, HoldsWhenTheErrorGrows) {
  ExecutePolicy::Request request = pull(0.9, 1.0);
  request.closed_loop = true;
  request.goal = goal_at(0.02, 0.0, -0.093);
  auto answer = execute_meanwhile(request);
  ASSERT_TRUE(spin_until([] { return robot->right == 0.9; }, 30.0));
  ASSERT_TRUE(spin_until([] { return robot->left != 1.0 || robot->right != 0.9; }, 30.0));  // the first correction
  robot->knock_m = 0.05;
  const auto stopped = answer.get();
  EXPECT_FALSE(stopped.success);
  EXPECT_NE(stopped.message.find("the error grows"), std::string::npos) << stopped.message;
  expect_commands_are_held();
}

TEST_F(Controller, HoldsWhenAMotorStalls) {
  auto answer = execute_meanwhile(pull(0.9, 20.0));
  wait_until_pulled();
  robot->stalled = true;
  const auto stopped = answer.get();
  EXPECT_FALSE(stopped.success);
  EXPECT_NE(stopped.message.find("motor left: stall"), std::string::npos) << stopped.message;
  expect_commands_are_held();

  const auto refused = execute(pull(0.9, 1.0));
  EXPECT_FALSE(refused.success);
  EXPECT_NE(refused.message.find("motor left: stall"), std::string::npos) << refused.message;
  expect_commands_are_held();
}

// Names without the numbers that belong to them, and numbers that are none.
TEST_F(Controller, GoesOnThoughMessagesAreNotWhole) {
  const pid_t process = process_of("/controller");
  MarkerObservations markers;
  markers.header.stamp = ros::Time(4.0e9);
  markers.names = {"tip", "middle"};
  markers.sources = {MarkerObservations::SEEN};
  ActuatorState actuators;
  actuators.names = {"left", "right"};
  actuators.commands = {std::nan("")};
  const auto simulated = node_.advertise<MarkerObservations>(topics::simulator_markers, 10);
  const auto tracked = node_.advertise<MarkerObservations>(topics::tracker_markers, 10);
  const auto states = node_.advertise<ActuatorState>(topics::simulator_actuators, 10);
  ASSERT_TRUE(spin_until([&] {
    return simulated.getNumSubscribers() > 0 && tracked.getNumSubscribers() > 0 && states.getNumSubscribers() > 0;
  }));
  auto answer = execute_meanwhile(pull(0.9, 10.0));
  wait_until_pulled();
  simulated.publish(markers);
  tracked.publish(markers);
  states.publish(actuators);
  const auto played = answer.get();
  EXPECT_TRUE(played.success) << played.message;
  EXPECT_TRUE(execute(pull(1.0, 1.0)).success);
  EXPECT_EQ(process_of("/controller"), process);
}

TEST_F(Controller, RepeatsTheLastCommandThatAMotorMayHaveRefused) {
  robot->refused = 0.9;
  EXPECT_TRUE(execute(pull(0.9, 1.0)).success);
  EXPECT_EQ(robot->refused, 0.0);
  EXPECT_EQ(robot->right, 0.9);
}

TEST_F(Controller, RefusesASecondPolicyWhileOneIsPlayed) {
  auto answer = execute_meanwhile(pull(0.9, 20.0));
  wait_until_pulled();
  ExecutePolicy::Request second = pull(0.8, 1.0);
  EXPECT_NE(execute(second).message.find("busy"), std::string::npos);
  second.closed_loop = true;
  second.goal = goal_at(0.02, 0.0, -0.093);
  EXPECT_NE(execute(second).message.find("busy"), std::string::npos);
  const auto first = answer.get();
  EXPECT_TRUE(first.success) << first.message;
  EXPECT_EQ(first.values, (std::vector<double>{1.0, 0.9}));
}

TEST_F(Controller, TellsWhatIsNearestToATargetOutOfReach) {
  const auto response = ask<OptimisePolicy>(node_, topics::optimise_policy, reach({0.02, 0.0, -0.12}));
  EXPECT_TRUE(response.success) << response.message;
  EXPECT_FALSE(response.summary.target_reached);
  EXPECT_NE(response.message.find("out of reach by "), std::string::npos) << response.message;
  EXPECT_TRUE(std::regex_search(
      response.message, std::regex("nearest: tip at \\[-?\\d+\\.\\d\\d, -?\\d+\\.\\d\\d, -?\\d+\\.\\d\\d\\] mm")))
      << response.message;
}

TEST_F(Controller, RefusesACorrectionWithoutAGoalThatItKnows) {
  ExecutePolicy::Request request = pull(0.9, 1.0);
  request.closed_loop = true;
  request.goal = goal_at(0.02, 0.0, -0.093);
  request.goal.markers = {"tail"};
  EXPECT_NE(execute(request).message.find("'tail'"), std::string::npos);
  expect_commands_are_held();
}

// Nothing moves by itself when roslaunch has started it again, and the next request is served.
TEST_F(Controller, HoldsWhenItsNodeIsKilledAndPlaysAgainWhenItIsBack) {
  const pid_t killed = process_of("/controller");
  auto answer = std::async(std::launch::async, [this] {
    ExecutePolicy::Request request = pull(0.9, 1000.0);
    ExecutePolicy::Response response;
    return node_.serviceClient<ExecutePolicy>(topics::execute_policy).call(request, response);
  });
  wait_until_pulled();
  ASSERT_EQ(kill(killed, SIGKILL), 0);
  EXPECT_FALSE(answer.get());
  EXPECT_NE(process_of("/controller"), killed);
  expect_commands_are_held();
  ExecutePolicy::Response again;
  ASSERT_TRUE(spin_until(
      [&] {
        ExecutePolicy::Request request = pull(1.0, 1.0);
        return node_.serviceClient<ExecutePolicy>(topics::execute_policy).call(request, again);
      },
      30.0));
  EXPECT_TRUE(again.success) << again.message;
}

}  // namespace
}  // namespace soft_robot_lab
