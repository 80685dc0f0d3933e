// SPDX-License-Identifier: BSD-3-Clause
// The panel's side of a session: what its topics say, and what is asked of its services. Knows no window. All but the
// services runs in the thread that calls it, and none of it waits.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <soft_robot_lab/MarkerObservations.h>
#include <soft_robot_lab/MotorState.h>
#include <soft_robot_lab/OptimisePolicy.h>
#include <soft_robot_lab/OptimisePolicyResult.h>
#include <soft_robot_lab/Policy.h>
#include <soft_robot_lab/Target.h>
#include <visualization_msgs/Marker.h>

#include "actuator_values.h"
#include "calls.h"
#include "history.h"
#include "lamps.h"
#include "reachable_tips.h"
#include "turn_watch.h"

namespace soft_robot_lab {

class PanelLink {
 public:
  // `session`: the namespace of its topics; empty for that of this node.
  explicit PanelLink(const std::string& session);

  void listen();  // takes what came since, and sends what was edited
  ActuatorValues& values() { return values_; }
  const ActuatorValues& values() const { return values_; }
  std::vector<Lamp> lamps() const;
  std::optional<Lamps::Training> training() const { return lamps_.training(now_s()); }
  const std::vector<std::string>& markers() const { return markers_.names; }
  // Of that marker: what was last searched for, else where it is; empty where neither is known.
  std::optional<geometry_msgs::Point> target(const std::string& marker) const;
  // What is plotted; of the marker that was asked for last.
  const History& history() const { return history_; }
  void plot(const std::string& marker) { plotted_ = marker; }
  int targets() const { return targets_; }  // how many were heard of
  int robots() const { return robots_; }    // likewise: another number, and nothing holds of before
  // The marker that was last searched for; empty: none yet, of this robot.
  std::string target_marker() const { return target_ ? target_->marker : ""; }

  bool offers(const std::string& service) const;
  std::string why_not(const std::string& service) const;  // be asked now, for its user; empty where it can be
  bool busy() const { return calls_.busy(slow_lane); }
  std::vector<CallOutcome> take_outcomes();  // of what was asked, and what else the window should say

  void optimise(const std::string& method, const std::string& marker, const Eigen::Vector3d& target_m);
  // Moves the ball in rviz there, and searches for nothing yet.
  void show_target(const std::string& marker, const Eigen::Vector3d& target_m);
  void execute();  // what was found last
  // In rviz's scene; none take those away that are there.
  void show_tips(const ReachableTips& tips, const TipQuantity& coloured_by);
  void diagnose(const TurnGap& longest);  // of the window, in the last second
  void play(const Policy& policy);
  void stop();                                           // all: searches, policies, drives
  const std::string& scene() const { return scene_; }    // path of what runs; empty: not known
  void load(const std::string& scene);                   // another robot
  const std::string& solver() const { return solver_; }  // asked for in this session; empty: not known
  void use_solver(const std::string& solver);
  // Around the skin of what runs, as it was first heard of; in robot_base.
  const std::optional<Eigen::AlignedBox3d>& robot_box() const { return robot_box_m_; }
  const std::string& robot_frame() const { return robot_frame_; }  // its name in this session
  void reset();  // the simulation's start; a rig goes to its rest commands
  bool recording() const { return recording_; }
  void record(bool on);
  void zero();
  void clear();
  void calibrate(bool with_balls);

  static double now_s();  // of this machine, steady

 private:
  static constexpr char slow_lane[] = "slow", quick_lane[] = "quick", look_lane[] = "look";

  void look_for_services();
  void forget();  // what belongs to the robot that runs no longer
  void on_scene(const std::string& scene);
  void on_markers(const MarkerObservations& markers);
  void on_target(const Target& target);
  void on_target_answer(const OptimisePolicyResult& answer);
  void on_surface(const visualization_msgs::Marker& surface);
  void on_ranges(const ActuatorRanges& ranges);
  bool send_edits();  // false where there are none
  void hold();        // the drives, where they are
  void report_where_nothing_moves();
  void ask_trigger(const std::string& lane, const std::string& title, const std::string& service);

  ActuatorValues values_;
  Lamps lamps_;
  MarkerObservations markers_;
  std::optional<Target> target_;
  int targets_ = 0, robots_ = 0;
  ros::Time started_;  // the scene
  std::string scene_, solver_, plotted_;
  History history_;
  std::optional<MotorState> motors_;  // of a rig
  bool recording_ = false;
  bool stopped_ = false;  // what runs in the slow lane, by the user
  std::vector<CallOutcome> notes_;
  double looked_at_s_ = -1.0;

  mutable std::mutex services_mutex_;
  std::set<std::string> services_;  // of the whole graph

  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  ros::Publisher commands_, target_shown_, tips_, diagnostics_;
  std::vector<ros::Subscriber> subscribers_;
  ros::Subscriber surface_;  // until the box is known
  std::optional<Eigen::AlignedBox3d> robot_box_m_;
  std::string robot_frame_;
  Calls calls_;  // last: its threads end first
};

}  // namespace soft_robot_lab
