// SPDX-License-Identifier: BSD-3-Clause
// A curve that a marker shall follow in time, and the file that names it (config/README, "Path").
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/control/find_policy.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// A chain of straight pieces by the way along it. Lengths in m, places in robot_base.
class Curve {
 public:
  Curve() = default;
  // Throws std::invalid_argument: fewer than two points, one that is not finite, or one within 1e-9 m of the one
  // before.
  explicit Curve(std::vector<Eigen::Vector3d> points_m);

  double length_m() const { return ways_m_.empty() ? 0.0 : ways_m_.back(); }
  Eigen::Vector3d at(double way_m) const;  // beyond its ends: these

 private:
  std::vector<Eigen::Vector3d> points_m_;
  std::vector<double> ways_m_;
};

struct PathTask {
  std::string marker;
  Curve curve;
  double tolerance_m = 5.0e-4;  // > 0; by so much may the marker miss the curve
  double duration_s = 20.0;     // >= 0; 0: as fast as the drives turn
  int samples = 96;             // [2, 10000], of commands along the curve, its ends among them
  std::vector<ActuatorBounds> bounds = {};
};

// Throws SettingsError: file, line, key, value, allowed range.
PathTask load_path_task(const std::string& file);
PathTask parse_path_task(const std::string& text, const std::string& source_name);

}  // namespace soft_robot_lab
