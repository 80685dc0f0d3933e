// SPDX-License-Identifier: BSD-3-Clause
// Where a robot's marker rests over all its commands, as the program `workspace` writes it. Knows no window.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

struct ReachableTip {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  double effort = 0.0;          // of the hardest working actuator
  double least_motion_m = 0.0;  // by the commands' whole range in the direction in which they move it least
  bool snaps = false;           // the body snaps here, or towards a neighbour
  std::vector<double> commands;
};

struct ReachableTips {
  std::string marker;
  std::string effort;                  // what `effort` is, with its unit; empty where nothing is measured
  std::vector<std::string> actuators;  // of the commands
  std::vector<ReachableTip> tips;
};

// A number of each tip, to colour it by.
struct TipQuantity {
  std::string label;           // with its unit
  std::vector<double> values;  // >= 0

  double largest() const;  // > 0, also where all values are 0
};

// The effort where one is measured, and the least motion.
std::vector<TipQuantity> quantities_of(const ReachableTips& tips);

// From results.csv: only the commands that have a rest state. Throws std::invalid_argument where it is no such table,
// or has no such marker.
ReachableTips read_reachable_tips(const std::string& csv, const std::string& marker);

}  // namespace soft_robot_lab
