// SPDX-License-Identifier: BSD-3-Clause
// The motors of an emulated rig behind their topics and services: the table of the thesis, an emergency stop, a stall,
// a killed node.
#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <soft_robot_lab/ActuatorCommand.h>
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

class Motors : public testing::Test {
 protected:
  Motors() {
    publisher_ = node_.advertise<ActuatorCommand>(topics::actuator_command, 1);
    subscribers_ = {node_.subscribe<MotorState>(
                        topics::motor_state, 1,
                        boost::function<void(const MotorState::ConstPtr&)>([this](const auto& m) { state = *m; })),
                    node_.subscribe<ShaftState>(
                        topics::rig_shafts, 1,
                        boost::function<void(const ShaftState::ConstPtr&)>([this](const auto& m) { truth = *m; })),
                    node_.subscribe<diagnostic_msgs::DiagnosticArray>(
                        "/diagnostics", 1,
                        boost::function<void(const diagnostic_msgs::DiagnosticArray::ConstPtr&)>(
                            [this](const auto& m) { level = m->status.at(0).level; }))};
    wait_for("a link and two motors at known places", [this] {
      return state.linked && state.known == std::vector<std::uint8_t>{1, 1} && !truth.names.empty() &&
             publisher_.getNumSubscribers() > 0;
    });
  }

  void command(const std::vector<double>& values) {
    ActuatorCommand message;
    message.names = {"left", "right"};
    message.values = values;
    publisher_.publish(message);
  }

  // Again and again while the motors rest: on a busy machine the link may be lost for a moment, and the motors stop.
  void command_until(const std::string& what, const std::vector<double>& values, const std::function<bool()>& reached) {
    ros::WallTime due;
    wait_for(what, [&] {
      if (ros::WallTime::now() > due && state.moving == std::vector<std::uint8_t>{0, 0}) {
        command(values);
        due = ros::WallTime::now() + ros::WallDuration(1.0);
      }
      return reached();
    });
  }

  void expect_shafts(const std::vector<double>& values, const std::vector<double>& steps) {
    command_until("the shafts", values, [&] { return truth.position_steps == steps; });
    wait_for("the state", [&] {
      return state.position_steps == steps && state.moving == std::vector<std::uint8_t>{0, 0};
    });
    EXPECT_EQ(state.target_steps, steps);
  }

  template <typename Service>
  typename Service::Response ask(const std::string& name, const typename Service::Request& request = {}) {
    return soft_robot_lab::ask<Service>(node_, name, request);
  }

  // What the board must do and can: again where the link was lost meanwhile, as on a busy machine it may be.
  template <typename Service>
  void expect_done(const std::string& name) {
    typename Service::Response response;
    wait_for(name, [&] {
      response = ask<Service>(name);
      const bool lost = response.message.find("link") != std::string::npos ||
                        response.message.find("not been read yet") != std::string::npos;
      return response.success || !lost;
    });
    EXPECT_TRUE(response.success) << response.message;
  }

  MotorState state;
  ShaftState truth;
  int level = -1;  // of the diagnostics
  ros::Publisher publisher_;

 private:
  ros::NodeHandle node_;
  std::vector<ros::Subscriber> subscribers_;
};

using Status = diagnostic_msgs::DiagnosticStatus;

// Sections 6.4 and 6.5: contractions and the steps they mean.
TEST_F(Motors, TurnTheShaftsToTheStepsOfTheThesis) {
  std::string robot;
  ASSERT_TRUE(ros::param::get("~robot", robot));
  if (robot == "spinebot") {
    expect_shafts({0.8, 1.1}, {258, -129});
    expect_shafts({0.9, 0.8}, {129, 258});
  } else {
    expect_shafts({1.2, 0.82}, {-320, 288});
    expect_shafts({0.7, 1.2}, {480, -320});
  }
  expect_shafts({1.0, 1.0}, {0, 0});
}

TEST_F(Motors, StopAtOnceAndStayStoppedUntilCleared) {
  command_until("motion", {0.75, 0.75}, [this] { return truth.position_steps.at(0) > 10; });
  EXPECT_TRUE(ask<std_srvs::Trigger>(topics::motor_stop).success);
  wait_for("the stop", [this] { return state.emergency_stop && truth.moving == std::vector<std::uint8_t>{0, 0}; });
  wait_for("yellow diagnostics", [this] { return level == Status::WARN; });  // it was asked for, and is no fault
  const auto stopped_at = truth.position_steps;
  command({0.8, 0.8});
  wait_for("the next states", [this, seen = state.header.seq] { return state.header.seq > seen + 20; });
  EXPECT_EQ(truth.position_steps, stopped_at);

  expect_done<std_srvs::Trigger>(topics::motor_clear);
  wait_for("green diagnostics", [this] { return level == Status::OK; });
  expect_shafts({1.0, 1.0}, {0, 0});
}

TEST_F(Motors, LatchAStallUntilClearedAndZeroed) {
  RigCommand::Request stall;
  stall.command = "stall 0 on";
  EXPECT_TRUE(ask<RigCommand>(topics::rig_command, stall).success);
  command_until("the fault", {0.8, 1.0}, [this] { return state.fault.at(0).find("stall") == 0; });
  EXPECT_FALSE(state.known.at(0));
  EXPECT_TRUE(state.fault.at(1).empty());
  wait_for("red diagnostics", [this] { return level == Status::ERROR; });
  EXPECT_FALSE(ask<ZeroMotors>(topics::motor_zero).success);

  stall.command = "stall 0 off";
  EXPECT_TRUE(ask<RigCommand>(topics::rig_command, stall).success);
  expect_done<std_srvs::Trigger>(topics::motor_clear);
  wait_for("a position to be set", [this] { return state.fault.at(0).find("position unknown") == 0; });
  expect_done<ZeroMotors>(topics::motor_zero);
  wait_for("a known position", [this] { return state.known.at(0) != 0; });
  command_until("the shaft", {0.9, 1.0},
                [this] { return truth.position_steps.at(0) > 100 && truth.moving.at(0) == 0; });
  EXPECT_EQ(state.fault.at(0), "");
}

// The board notices the silence; the node comes back by roslaunch and reads where the shafts are.
TEST_F(Motors, StopWhenTheirNodeIsKilledAndMoveFromThereWhenItIsBack) {
  command_until("the longest cables", {1.2, 1.2},
                [this] { return state.position_steps == state.target_steps && state.position_steps.at(0) < -250; });
  const auto first_node = process_of("/motor");
  const double start_steps = truth.position_steps.at(0);
  command_until("motion", {0.7, 0.7}, [&] { return truth.position_steps.at(0) > start_steps + 20; });
  wait_for("the target", [this] { return state.target_steps.at(0) > 380; });
  const double target_steps = state.target_steps.at(0);
  ASSERT_EQ(kill(first_node, SIGKILL), 0);
  wait_for("the watchdog's stop", [this] { return truth.moving == std::vector<std::uint8_t>{0, 0}; });
  const auto stopped_at = truth.position_steps;
  EXPECT_LT(stopped_at.at(0), target_steps);

  state = {};
  wait_for("the node to be back", [this] {
    return state.linked && state.known == std::vector<std::uint8_t>{1, 1} && publisher_.getNumSubscribers() > 0;
  });
  EXPECT_NE(process_of("/motor"), first_node);
  EXPECT_EQ(state.position_steps, stopped_at);
  EXPECT_EQ(truth.position_steps, stopped_at);
  expect_shafts({1.0, 1.0}, {0, 0});
}

TEST_F(Motors, TakeCommandsThatWereSentApartAndArriveTogether) {
  expect_shafts({1.0, 1.0}, {0, 0});
  ros::Publisher publisher = ros::NodeHandle().advertise<ActuatorCommand>(topics::actuator_command, 10);
  wait_for("a second hand", [&] { return publisher.getNumSubscribers() >= publisher_.getNumSubscribers(); });
  ros::WallDuration(0.1).sleep();  // both are sent after the shafts' command, by their stamps too
  ActuatorCommand first, second;
  first.names = second.names = {"left", "right"};
  first.values = {0.95, 1.0};
  second.values = {1.0, 0.95};
  second.header.stamp = ros::Time::now();
  first.header.stamp = second.header.stamp - ros::Duration(0.02);
  publisher.publish(first);
  publisher.publish(second);
  wait_for("the second command", [&] { return state.target_steps[0] == 0.0 && state.target_steps[1] != 0.0; });
}

// More than one line, and more than one message of the socket; the emulator, its node and their answers stay.
TEST_F(Motors, RefuseWhatIsNotOneRigCommand) {
  RigCommand::Request request;
  for (const std::string& text :
       {std::string("counts\nunplug"), std::string(100000, 'x'), std::string("counts\0", 7)}) {
    request.command = text;
    EXPECT_FALSE(ask<RigCommand>(topics::rig_command, request).success);
  }
  request.command = "counts";
  const auto response = ask<RigCommand>(topics::rig_command, request);
  EXPECT_TRUE(response.success);
  EXPECT_EQ(std::count(response.message.begin(), response.message.end(), ' '), 4) << response.message;
  const ros::Time before = truth.header.stamp;
  wait_for("the shafts", [&] { return truth.header.stamp > before; });
}

TEST_F(Motors, AreAtZeroWhenTheySaySo) {
  command_until("a place", {0.9, 0.9}, [this] { return state.position_steps.at(0) != 0.0; });
  wait_for("rest", [this] { return state.moving == std::vector<std::uint8_t>{0, 0}; });
  EXPECT_TRUE(ask<ZeroMotors>(topics::motor_zero, ZeroMotors::Request()).success);
  const ros::Time answered = ros::Time::now();
  wait_for("a state after the answer", [&] { return state.header.stamp > answered; });
  EXPECT_EQ(state.position_steps, (std::vector<double>{0, 0}));
}

TEST_F(Motors, RefuseUnknownRigCommandsAndMotors) {
  RigCommand::Request nonsense;
  nonsense.command = "explode";
  EXPECT_FALSE(ask<RigCommand>(topics::rig_command, nonsense).success);
  ZeroMotors::Request nobody;
  nobody.names = {"middle"};
  const auto response = ask<ZeroMotors>(topics::motor_zero, nobody);
  EXPECT_FALSE(response.success);
  EXPECT_EQ(response.message, "'middle' is not one of left, right");
}

}  // namespace
}  // namespace soft_robot_lab
