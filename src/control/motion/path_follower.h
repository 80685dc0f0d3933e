// SPDX-License-Identifier: BSD-3-Clause
// Plays a plan, and corrects it at the rate of the tracker. The model says where the marker would be without
// disturbance but with the corrections that had come through when the frame was taken; what is measured beyond that is
// the disturbance, which a filter follows and the damped inverse of the planned Jacobian takes off the commands. As
// corrections on their way are known, a late frame does not correct twice.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "soft_robot_lab/control/motion/plan_motion.h"

namespace soft_robot_lab {

struct FollowOptions {
  bool feedback = true;           // without it the plan is played, and sights are not asked for
  double gain = 0.3;              // (0, 1], of a disturbance's change that is taken up by one frame
  double damping = 0.05;          // (0, 1], as LearnOptions'
  double drive_lag_s = 0.03;      // >= 0, from a command to the marker
  double lead_s = 0.0;            // >= 0, by which commands are ahead of the plan
  double hold_after_s = 0.3;      // > 0: no sight for so long, and the robot is held where it is on the path
  double lost_after_s = 2.0;      // above hold_after_s: and for so long, the path ends
  double largest_error_m = 0.03;  // > 0: a marker further from its target ends the path
  void validate() const;          // throws std::invalid_argument: field, value, allowed range
};

struct StampedMarker {
  double stamp_s = 0.0;                                  // when the frame was taken, by the clock of next()
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // robot_base
};

enum class PathEnd { none, done, marker_lost, fault, error_too_large };

struct FollowStep {
  PathEnd end = PathEnd::none;
  std::string reason;        // for a reader, where it ended before the path's end
  bool holding = false;      // waits for the marker
  double path_s = 0.0;       // of the plan's times
  Eigen::VectorXd commands;  // of drives, within their limits; at an end those that the robot has, to be held
};

class PathFollower {
 public:
  // The robot rests at the plan's first commands, and its drives came there pulling. Throws std::invalid_argument for a
  // plan that is not complete.
  PathFollower(PathPlan plan, const FollowOptions& options);

  // `time_s` rises from call to call. `seen`: a sight that has come since the last call. `fault`: what is wrong with
  // the drives, empty for nothing. After an end it gives the same end again.
  FollowStep next(double time_s, const std::optional<StampedMarker>& seen, const std::string& fault);

  const PathPlan& plan() const { return plan_; }
  // Where on the path it was at that time, by the clock of next().
  double path_at(double time_s) const;
  const Eigen::Vector3d& disturbance_m() const { return disturbance_m_; }

 private:
  struct Sent {
    double time_s, path_s;
    Eigen::VectorXd correction;
  };

  void take_up(const StampedMarker& seen);
  Sent sent_at(double time_s) const;
  FollowStep stop(PathEnd end, const std::string& reason);
  bool is_lost(double time_s, FollowStep& step);
  Eigen::VectorXd wanted_commands(double path_s, double passed_s);

  PathPlan plan_;
  FollowOptions options_;
  double damping_m_;
  PlayInverse play_;
  std::deque<Sent> sent_;
  std::optional<double> start_s_, last_s_, last_sight_s_;
  double path_s_ = 0.0;
  double missed_m_ = 0.0;  // by the last sight
  Eigen::Vector3d disturbance_m_ = Eigen::Vector3d::Zero();
  Eigen::VectorXd wanted_;  // without play
  FollowStep last_;
};

}  // namespace soft_robot_lab
