// SPDX-License-Identifier: BSD-3-Clause
// What a session's topics say to the panel. Knows no window.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <ros/ros.h>
#include <soft_robot_lab/MarkerObservations.h>
#include <soft_robot_lab/MotorState.h>
#include <soft_robot_lab/OptimisePolicyResult.h>
#include <soft_robot_lab/Target.h>
#include <visualization_msgs/Marker.h>

#include "actuator_values.h"
#include "calls.h"
#include "history.h"
#include "lamps.h"

namespace soft_robot_lab {

// The skin of what runs, as it was first heard of.
struct RobotBox {
  Eigen::AlignedBox3d box_m;
  std::string frame;  // robot_base, by its name in this session
};

class SessionState {
 public:
  // Hears the topics of the node's namespace, in the thread that serves its queue.
  explicit SessionState(const ros::NodeHandle& node);

  void end_turn();  // between messages: hears no longer what is known

  ActuatorValues& values() { return values_; }
  const ActuatorValues& values() const { return values_; }
  const Lamps& lamps() const { return lamps_; }
  const MarkerObservations& markers() const { return markers_; }
  // Of that marker: what was last searched for, else where it is; empty where neither is known.
  std::optional<geometry_msgs::Point> target(const std::string& marker) const;
  // The marker that was last searched for; empty: none yet, of this robot.
  std::string target_marker() const { return target_ ? target_->marker : ""; }
  int targets() const { return targets_; }  // how many were heard of
  int robots() const { return robots_; }    // likewise: another number, and nothing holds of before
  // What is plotted; of the marker that was asked for last.
  const History& history() const { return history_; }
  void plot(const std::string& marker) { plotted_ = marker; }
  const std::string& scene() const { return running_.scene; }    // path of what runs; empty: not known
  const std::string& solver() const { return running_.solver; }  // asked for in this session; empty: not known
  const std::optional<RobotBox>& robot_box() const { return robot_box_; }
  const std::optional<MotorState>& motors() const { return motors_; }  // of a rig
  bool recording() const { return running_.recorded; }

  std::vector<CallOutcome> take_notes();  // what the window should say of it

 private:
  void forget();  // what belongs to the robot that runs no longer
  void on_actuators(const ActuatorState& actuators);
  void on_scene(const std::string& scene);
  void on_markers(const MarkerObservations& markers);
  void on_target(const Target& target);
  void on_target_answer(const OptimisePolicyResult& answer);
  void on_gap(const RealityGap& gap);
  void on_surface(const visualization_msgs::Marker& surface);
  void on_ranges(const ActuatorRanges& ranges);

  struct Running {
    std::string scene, solver;
    ros::Time since;
    bool recorded = false;
  };

  ActuatorValues values_;
  Lamps lamps_;
  MarkerObservations markers_;
  std::optional<Target> target_;
  int targets_ = 0, robots_ = 0;
  Running running_;
  std::string plotted_;
  History history_;
  std::optional<MotorState> motors_;
  std::optional<RobotBox> robot_box_;
  std::vector<CallOutcome> notes_;

  ros::NodeHandle node_;
  std::vector<ros::Subscriber> subscribers_;
  ros::Subscriber surface_;  // until the box is known
};

}  // namespace soft_robot_lab
