// SPDX-License-Identifier: BSD-3-Clause
// The panel's side of a session: what its topics say, what is sent to it, and what is asked of its services. Knows no
// window. All but the services runs in the thread that calls it, and none of it waits.
#pragma once

#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <soft_robot_lab/Policy.h>

#include "calls.h"
#include "reachable_tips.h"
#include "session_state.h"
#include "turn_watch.h"

namespace soft_robot_lab {

class PanelLink {
 public:
  // `session`: the namespace of its topics; empty for that of this node.
  explicit PanelLink(const std::string& session);

  void listen();  // takes what came since, and sends what was edited
  SessionState& state() { return state_; }
  const SessionState& state() const { return state_; }

  std::vector<Lamp> lamps() const;
  std::optional<Lamps::Training> training() const;
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
  void stop();                          // all: searches, policies, drives
  void load(const std::string& scene);  // another robot
  void use_solver(const std::string& solver);
  void reset();  // the simulation's start; a rig goes to its rest commands
  void record(bool on);
  void zero();
  void clear();
  void calibrate(bool with_balls);

 private:
  static constexpr char slow_lane[] = "slow", quick_lane[] = "quick", look_lane[] = "look";

  void look_for_services();
  bool send_edits();  // false where there are none
  void hold();        // the drives, where they are
  void report_where_nothing_moves();
  void ask_trigger(const std::string& lane, const std::string& title, const std::string& service);

  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  SessionState state_;
  ros::Publisher commands_, target_shown_, tips_, diagnostics_;
  bool stopped_ = false;  // what runs in the slow lane, by the user
  std::vector<CallOutcome> notes_;
  double looked_at_s_ = -1.0;

  mutable std::mutex services_mutex_;
  std::set<std::string> services_;  // of the whole graph

  Calls calls_;  // last: its threads end first
};

}  // namespace soft_robot_lab
