// SPDX-License-Identifier: BSD-3-Clause
// A softer bar than the controller's model, with motors and a tracker, behind the topics of a session. It rests at once
// wherever it is commanded to, and its session's time runs five times as fast as the wall's.
#pragma once

#include <atomic>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <soft_robot_lab/MotorState.h>
#include <std_msgs/String.h>

#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "ros/messages/conversions.h"
#include "ros/base/topics.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

class StubRobot {
 public:
  explicit StubRobot(const std::string& scenes) {
    SceneOptions options;
    options.actuator_factory = make_actuator;
    robot_ = std::move(load_scene(scenes + "cable_bar_soft.yaml", options).simulation);
    robot_->solve_equilibrium();
    node_.setCallbackQueue(&queue_);
    scene_ = node_.advertise<std_msgs::String>(topics::simulator_scene, 1, true);
    simulated_ = node_.advertise<MarkerObservations>(topics::simulator_markers, 10);
    tracked_ = node_.advertise<MarkerObservations>(topics::tracker_markers, 10);
    motors_ = node_.advertise<MotorState>(topics::motor_state, 10);
    commands_ = node_.subscribe(topics::actuator_command, 100, &StubRobot::on_command, this);
    std_msgs::String path;
    path.data = scenes + "cable_bar.yaml";
    scene_.publish(path);
    timer_ = node_.createWallTimer(ros::WallDuration(0.02), [this](const auto&) { tick(); });
    spinner_.start();
  }
  ~StubRobot() { spinner_.stop(); }

  std::atomic<bool> tip_seen{true}, middle_seen{true};
  std::atomic<bool> stalled{false};           // the left motor
  std::atomic<double> knock_m{0.0};           // by which all is seen elsewhere
  std::atomic<double> last_command_s{0.0};    // when it was sent
  std::atomic<double> left{1.0}, right{1.0};  // as commanded
  std::atomic<double> refused{0.0};           // the next command with this value of the right cable is

 private:
  void on_command(const ActuatorCommand& command) {
    last_command_s = command.header.stamp.toSec();
    if (command.values.back() == refused) {
      refused = 0.0;
      return;
    }
    left = command.values.front();
    right = command.values.back();
    apply_command(command, *robot_);
    robot_->solve_equilibrium();
  }

  void tick() {
    stamp_ += ros::Duration(0.1);
    simulated_.publish(marker_observations(*robot_, stamp_));
    tracked_.publish(tracked());
    motors_.publish(motors());
  }

  MarkerObservations tracked() const {
    MarkerObservations seen = marker_observations(*robot_, stamp_);
    for (size_t i = 0; i < seen.names.size(); ++i) {
      seen.sources[i] = (seen.names[i] == "tip" ? tip_seen : middle_seen) ? MarkerObservations::SEEN
                                                                          : MarkerObservations::INTERPOLATED;
      seen.positions[i].x += knock_m;
    }
    return seen;
  }

  MotorState motors() const {
    MotorState state;
    state.linked = true;
    state.names = {"left", "right"};
    state.moving = {0, 0};
    state.fault = {stalled ? "stall; clear it with motor/clear" : "", ""};
    return state;
  }

  std::unique_ptr<Simulation> robot_;
  ros::Time stamp_{100.0};
  ros::CallbackQueue queue_;
  ros::AsyncSpinner spinner_{1, &queue_};
  ros::NodeHandle node_;
  ros::Publisher scene_, simulated_, tracked_, motors_;
  ros::Subscriber commands_;
  ros::WallTimer timer_;
};

}  // namespace soft_robot_lab
