// SPDX-License-Identifier: BSD-3-Clause
// A path that is followed by the session's time: its follower is asked for commands no faster than drives take them,
// and how far the marker is from where it should be is kept.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "control/motion/path_follower.h"
#include "marker_frame.h"

namespace soft_robot_lab {

constexpr double kFollowPeriod_s = 0.03;  // at least, between two commands

class FollowedPath {
 public:
  // Keeps a reference to the follower, whose path begins at `start_s` of the session's time.
  FollowedPath(PathFollower& follower, double start_s) : follower_(follower), start_s_(start_s) {}

  // nullopt where it is too early for new commands.
  std::optional<FollowStep> next(double now_s);
  bool ended() const { return last_.end != PathEnd::none; }
  const FollowStep& last() const { return last_; }

  // Frames of before the start, or without the marker, do not count.
  void add_measured(const MarkerFrame& frame);
  void add_simulated(double stamp_s, const Eigen::Vector3d& position_m);

  const MarkerTrack& measured() const { return measured_.track; }  // times since the start
  // Root mean square distance from where the marker should be. nullopt where it was never heard of.
  std::optional<double> measured_rms_m() const { return measured_.rms_m(); }
  std::optional<double> simulated_rms_m() const { return simulated_.rms_m(); }
  std::optional<double> last_distance_m() const;  // measured, else simulated

 private:
  struct Distances {
    MarkerTrack track;
    double squares_m2 = 0.0;
    double last_m = 0.0;
    std::optional<double> rms_m() const;
  };
  void add(double stamp_s, const Eigen::Vector3d& position_m, Distances& distances) const;

  PathFollower& follower_;
  double start_s_;
  FollowStep last_;
  std::optional<double> asked_s_;
  std::optional<StampedMarker> sight_;  // not yet handed to the follower
  Distances measured_, simulated_;
};

}  // namespace soft_robot_lab
