// SPDX-License-Identifier: BSD-3-Clause
// Policies on an emulated rig: played, and stopped where a motor stalls or the motors' node is killed.
#include <csignal>
#include <future>
#include <string>

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <soft_robot_lab/ActuatorCommand.h>
#include <soft_robot_lab/ExecutePolicy.h>
#include <soft_robot_lab/MotorState.h>
#include <soft_robot_lab/RigCommand.h>
#include <soft_robot_lab/ShaftState.h>
#include <soft_robot_lab/ZeroMotors.h>
#include <std_srvs/Trigger.h>

#include "process_of.h"
#include "session_ears.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

class RigSession : public testing::Test {
 protected:
  RigSession() {
    subscribers_ = {node_.subscribe<MotorState>(
                        topics::motor_state, 1,
                        boost::function<void(const MotorState::ConstPtr&)>([this](const auto& m) { motors = *m; })),
                    node_.subscribe<ShaftState>(
                        topics::rig_shafts, 1,
                        boost::function<void(const ShaftState::ConstPtr&)>([this](const auto& m) { truth = *m; })),
                    node_.subscribe<ActuatorCommand>(topics::actuator_command, 100,
                                                     boost::function<void(const ActuatorCommand::ConstPtr&)>(
                                                         [this](const auto& m) { last_command = m->header.stamp; }))};
    expect_ready();
  }

  void expect_ready() {
    motors = {};
    ASSERT_TRUE(spin_until([this] { return motors.linked && motors.fault == std::vector<std::string>{"", ""}; }, 60.0));
  }

  std::future<ExecutePolicy::Response> pull(double right, double time_s) {
    ExecutePolicy::Request request;
    request.policy.names = {"left", "right"};
    request.policy.steps.resize(1);
    request.policy.steps[0].time_s = time_s;
    request.policy.steps[0].values = {1.0, right};
    request.wait_until_rest = true;
    return std::async(std::launch::async,
                      [this, request] { return ask<ExecutePolicy>(node_, topics::execute_policy, request); });
  }

  // A busy machine may lose the link for a moment, which stops the policy rightly.
  void expect_plays(double right) {
    for (int attempt = 0; attempt < 3; ++attempt) {
      expect_ready();
      const auto answer = finish(pull(right, 2.0));
      if (!answer.success && answer.message.find("no link") != std::string::npos) continue;
      EXPECT_TRUE(answer.success) << answer.message;
      break;
    }
    EXPECT_TRUE(spin_until([&] { return std::abs(motors.values.at(1) - right) < 1e-3; }));
  }

  ExecutePolicy::Response finish(std::future<ExecutePolicy::Response> answer) {
    EXPECT_TRUE(
        spin_until([&] { return answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }, 60.0));
    return answer.get();
  }

  // By their stamps: on a busy machine one that was sent before may come later.
  void expect_commands_are_held() {
    const ros::Time from = ros::Time::now();
    const auto seen = motors.header.seq;
    ASSERT_TRUE(spin_until([&] { return motors.header.seq > seen + 20; }));
    EXPECT_LE(last_command, from);
    EXPECT_EQ(truth.moving, (std::vector<std::uint8_t>{0, 0}));
  }

  void report_rig(const std::string& command) {
    RigCommand::Request request;
    request.command = command;
    EXPECT_TRUE(ask<RigCommand>(node_, topics::rig_command, request).success);
  }

  MotorState motors;
  ShaftState truth;
  ros::Time last_command;
  ros::NodeHandle node_;

 private:
  std::vector<ros::Subscriber> subscribers_;
};

TEST_F(RigSession, HoldsWhenAMotorStallsAndPlaysAgainWhenItIsCleared) {
  expect_plays(0.95);
  report_rig("stall 1 on");
  const auto stopped = finish(pull(0.8, 30.0));
  EXPECT_FALSE(stopped.success);
  EXPECT_NE(stopped.message.find("motor right: stall"), std::string::npos) << stopped.message;
  EXPECT_LT(stopped.duration_s, 30.0);
  expect_commands_are_held();

  report_rig("stall 1 off");
  EXPECT_TRUE(ask<std_srvs::Trigger>(node_, topics::motor_clear).success);
  EXPECT_TRUE(ask<ZeroMotors>(node_, topics::motor_zero).success);
  expect_plays(1.0);
}

TEST_F(RigSession, HoldsWhenTheMotorsNodeIsKilledAndPlaysAgainWhenItIsBack) {
  expect_plays(1.0);
  const pid_t killed = process_of("/motor");
  auto answer = pull(0.8, 30.0);
  ASSERT_TRUE(spin_until([this] { return truth.position_steps.at(1) > 5; }));
  ASSERT_EQ(kill(killed, SIGKILL), 0);
  const auto stopped = finish(std::move(answer));
  EXPECT_FALSE(stopped.success);
  const bool said =
      stopped.message.find("silent") != std::string::npos || stopped.message.find("no link") != std::string::npos;
  EXPECT_TRUE(said) << stopped.message;
  EXPECT_LT(stopped.duration_s, 30.0);
  expect_ready();
  expect_commands_are_held();
  EXPECT_NE(process_of("/motor"), killed);
  expect_plays(0.95);
}

}  // namespace
}  // namespace soft_robot_lab
