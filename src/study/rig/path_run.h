// SPDX-License-Identifier: BSD-3-Clause
// A plan is played on the emulated rig, with what the tracker sees of it.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "emulated_lab.h"
#include "control/motion/path_follower.h"

namespace soft_robot_lab {

struct PathEyes {
  double frame_rate_hz = 28.0;
  double delay_s = 0.08;               // from a frame to its markers
  std::optional<double> noise_m = {};  // of a coordinate: true places with noise; empty: rendered cameras
  Eigen::Isometry3d base_from_measured = Eigen::Isometry3d::Identity();
};

struct PathRecord {
  std::vector<double> time_s;  // since the start
  std::vector<Eigen::Vector3d> true_m, target_m;
  MarkerTrack seen;  // by stamps since the start
  FollowStep last;
  double rms_m() const;                                      // of true_m from target_m
  double rms_within_m(const Eigen::Vector3d& normal) const;  // without what is along the normal of a plane
  double late_by_s() const;                                  // behind the target, on the mean
};

// What the rig says of the drives: limits, how fast they are with a command for each frame, and play from `backlash_m`.
std::vector<PathDrive> drives_of(const RigSettings& rig, const std::map<std::string, double>& backlash_m,
                                 double frame_rate_hz);

// From rest commands to the plan's start, to rest there, and along it. Throws as EmulatedLab does, but a fault on the
// path is handed to the follower.
PathRecord run_path(EmulatedLab& lab, const PathPlan& plan, const FollowOptions& options, const PathEyes& eyes,
                    const std::vector<double>& rest_commands);

}  // namespace soft_robot_lab
