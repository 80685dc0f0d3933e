// SPDX-License-Identifier: BSD-3-Clause
// The pressure channels of an emulated rig behind their topics and services, and the finger that their air bends.
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <soft_robot_lab/ActuatorCommand.h>
#include <soft_robot_lab/MarkerObservations.h>
#include <soft_robot_lab/MotorState.h>
#include <soft_robot_lab/PressureState.h>
#include <soft_robot_lab/RigCommand.h>
#include <soft_robot_lab/ShaftState.h>
#include <std_srvs/Trigger.h>

#include "session_ears.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

using Status = diagnostic_msgs::DiagnosticStatus;

class Pressures : public testing::Test {
 protected:
  Pressures() {
    publisher_ = node_.advertise<ActuatorCommand>(topics::actuator_command, 1);
    hear(topics::pressure_state, state);
    hear(topics::motor_state, motors);
    hear(topics::rig_shafts, truth);
    hear(topics::plant_markers, markers);
    subscribers_.push_back(node_.subscribe<diagnostic_msgs::DiagnosticArray>(
        "/diagnostics", 10,
        boost::function<void(const diagnostic_msgs::DiagnosticArray::ConstPtr&)>([this](const auto& m) {
          for (const auto& status : m->status)
            if (status.name.find("motors") != std::string::npos) lamp = status;
        })));
    wait_for("a link, measured pressures and a robot", [this] {
      return state.linked && state.known == std::vector<std::uint8_t>{1} && !truth.names.empty() &&
             !markers.positions.empty() && publisher_.getNumSubscribers() > 0;
    });
  }

  template <class Message>
  void hear(const std::string& topic, Message& message) {
    subscribers_.push_back(node_.subscribe<Message>(
        topic, 1,
        boost::function<void(const typename Message::ConstPtr&)>([&message](const auto& m) { message = *m; })));
  }

  // Again and again: on a busy machine the link may be lost for a moment, and the air goes out.
  void command_until(const std::string& what, double value_pa, const std::function<bool()>& reached) {
    ros::WallTime due;
    wait_for(what, [&] {
      if (ros::WallTime::now() > due) {
        ActuatorCommand message;
        message.names = {"a"};
        message.values = {value_pa};
        publisher_.publish(message);
        due = ros::WallTime::now() + ros::WallDuration(1.0);
      }
      return reached();
    });
  }

  void reach(double value_pa) {
    command_until("the pressure", value_pa, [&] {
      return state.set_point_pa.at(0) == value_pa && std::abs(state.pressure_pa.at(0) - value_pa) < 2000.0;
    });
  }

  std::string ask_rig(const std::string& command) {
    RigCommand::Request request;
    request.command = command;
    const auto response = soft_robot_lab::ask<RigCommand>(node_, topics::rig_command, request);
    return response.success ? "" : response.message;
  }
  std_srvs::Trigger::Response trigger(const std::string& name) {
    return soft_robot_lab::ask<std_srvs::Trigger>(node_, name, {});
  }
  void clear() {
    wait_for("a board that clears its faults", [this] { return trigger(topics::motor_clear).success; });
    wait_for("no fault", [this] { return state.fault.at(0).empty() && !state.emergency_stop; });
  }
  double bent_m() const { return std::abs(markers.positions.at(0).x); }

  PressureState state;
  MotorState motors;
  ShaftState truth;
  MarkerObservations markers;
  Status lamp;
  ros::Publisher publisher_;

 private:
  ros::NodeHandle node_;
  std::vector<ros::Subscriber> subscribers_;
};

TEST_F(Pressures, BendTheFinger) {
  const double at_rest_m = bent_m();
  reach(30000);
  wait_for("the true pressure", [this] { return std::abs(truth.values.at(0) - 30000) < 2000.0; });
  wait_for("a finger that bends", [&] { return bent_m() > at_rest_m + 0.002; });
  wait_for("a green lamp", [this] { return lamp.level == Status::OK && !lamp.name.empty(); });
  EXPECT_EQ(state.fault, std::vector<std::string>(1));
  EXPECT_NEAR(motors.values.at(0), 30000, 3000);
  reach(0);
  wait_for("a finger that is straight again", [&] { return bent_m() < at_rest_m + 0.001; });
}

TEST_F(Pressures, ReportABurstTubeByTheirLamp) {
  reach(30000);
  EXPECT_EQ(ask_rig("burst 0 on"), "");
  wait_for("the fault", [this] { return state.fault.at(0).find("burst tube") == 0; });
  wait_for("a red lamp that names it",
           [this] { return lamp.level == Status::ERROR && lamp.message.find("a: burst tube") != std::string::npos; });
  wait_for("no air", [this] { return truth.values.at(0) < 1000.0 && state.set_point_pa.at(0) == 0.0; });
  EXPECT_NE(motors.fault.at(0), "");
  EXPECT_EQ(ask_rig("burst 0 off"), "");
  clear();
  wait_for("a green lamp", [this] { return lamp.level == Status::OK; });
  reach(20000);
}

TEST_F(Pressures, AreLetOutByStopAndHeldUntilClear) {
  reach(20000);
  EXPECT_TRUE(trigger(topics::motor_stop).success);
  wait_for("no air", [this] { return state.emergency_stop && truth.values.at(0) < 1000.0; });
  wait_for("a yellow lamp", [this] { return lamp.level == Status::WARN; });
  clear();
  reach(20000);
}

TEST_F(Pressures, RefuseCommandsOfMotors) {
  EXPECT_NE(ask_rig("stall 0 on"), "");
  EXPECT_FALSE(ros::service::exists(topics::motor_zero, false));
}

}  // namespace
}  // namespace soft_robot_lab
