// SPDX-License-Identifier: BSD-3-Clause
// A closed loop whose cameras are unplugged one after the other: it goes on with the second, and holds without any.
#include <csignal>
#include <future>
#include <string>

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <soft_robot_lab/ActuatorCommand.h>
#include <soft_robot_lab/ExecutePolicy.h>

#include "process_of.h"
#include "session_ears.h"
#include "ros/messages/conversions.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

// A centimetre beside the plane in which the cables move the tip: what is left of the distance is no zero.
const Eigen::Vector3d target_m(0.01, 0.01, -0.098);

ExecutePolicy::Request closed_loop() {
  ExecutePolicy::Request request;
  request.policy.names = {"left", "right"};
  request.policy.steps.resize(1);
  request.policy.steps[0].time_s = 0.5;
  request.policy.steps[0].values = {1.0, 0.97};
  request.closed_loop = true;
  request.goal.markers = {"tip"};
  request.goal.targets = {to_message(target_m)};
  return request;
}

class UnpluggedCameras : public testing::Test {
 protected:
  UnpluggedCameras() {
    commands_ = node_.subscribe<ActuatorCommand>(
        topics::actuator_command, 100,
        boost::function<void(const ActuatorCommand::ConstPtr&)>([this](const auto&) { ++commands; }));
  }

  ExecutePolicy::Response execute_and_unplug(const std::string& camera) {
    const pid_t process = process_of(camera);
    hear<MarkerObservations>(node_, topics::tracker_markers);
    commands = 0;
    auto answer = std::async(std::launch::async,
                             [this] { return ask<ExecutePolicy>(node_, topics::execute_policy, closed_loop()); });
    EXPECT_TRUE(spin_until([this] { return commands > 5; }));
    EXPECT_EQ(kill(process, SIGKILL), 0);
    unplugged_at = commands;
    const auto ready = [&] { return answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready; };
    EXPECT_TRUE(spin_until(ready, 60.0));
    return answer.get();
  }

  // By the simulation, which knows.
  Eigen::Vector3d true_tip_m() {
    return position_of(*hear<MarkerObservations>(node_, topics::simulator_markers), "tip");
  }

  void let_pass(int steps) {
    for (int i = 0; i < steps; ++i) hear<MarkerObservations>(node_, topics::simulator_markers);
  }

  int commands = 0, unplugged_at = 0;
  ros::NodeHandle node_;

 private:
  ros::Subscriber commands_;
};

TEST_F(UnpluggedCameras, LeaveALoopThatGoesOnWithTheOtherAndThenHolds) {
  const auto corrected = execute_and_unplug("/other");
  EXPECT_TRUE(corrected.success) << corrected.message;
  EXPECT_EQ(corrected.message, "settled");
  const Eigen::Vector3d tip_m = true_tip_m();
  EXPECT_NEAR(corrected.final_distance_m, (tip_m - target_m).norm(), 1e-3);
  EXPECT_NEAR(tip_m.x(), target_m.x(), 2e-3);
  EXPECT_GE(corrected.corrections, 2);
  EXPECT_GT(commands, unplugged_at);

  const auto stopped = execute_and_unplug("/eye");
  EXPECT_FALSE(stopped.success);
  EXPECT_NE(stopped.message.find("tracking lost"), std::string::npos) << stopped.message;
  let_pass(20);  // what was sent before has come
  const int before = commands;
  let_pass(20);
  EXPECT_EQ(commands, before);
}

}  // namespace
}  // namespace soft_robot_lab
