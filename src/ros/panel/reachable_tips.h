// SPDX-License-Identifier: BSD-3-Clause
// Where a robot's marker rests over all its commands, as the program `workspace` writes it. Knows no window.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

struct ReachableTip {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  double effort = 0.0;  // of the hardest working actuator
  bool snaps = false;   // the body snaps here, or towards a neighbour
  std::vector<double> commands;
};

struct ReachableTips {
  std::string marker;
  std::string effort;                  // what `effort` is, with its unit; empty where nothing is measured
  std::vector<std::string> actuators;  // of the commands
  std::vector<ReachableTip> tips;

  double largest_effort() const;
};

// From results.csv: only the commands that have a rest state. Throws std::invalid_argument where it is no such table,
// or has no such marker.
ReachableTips read_reachable_tips(const std::string& csv, const std::string& marker);

}  // namespace soft_robot_lab
