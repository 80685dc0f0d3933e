// SPDX-License-Identifier: BSD-3-Clause
// Parameters of simulator_node.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <ros/ros.h>

#include "read_parameter.h"
#include "settings/require_in_range.h"

namespace soft_robot_lab {

inline void require_solver(const std::string& solver) {
  if (!solver.empty() && solver != "newton" && solver != "xpbd" && solver != "reduced")
    throw std::invalid_argument("solver: '" + solver + "' is none of newton, xpbd, reduced; empty: the scene's own");
}

struct SimulatorOptions {
  std::string scene;
  std::string solver;             // newton, xpbd or reduced; empty: the scene's own
  double real_time_factor = 1.0;  // [0, 1000]; 0: as fast as possible
  bool start_at_rest = true;
  double surface_rate_hz = 15.0;  // (0, 1000]
  double skin_opacity = 0.0;      // [0, 1]; 0: fitting_opacity
  bool publish_clock = true;
  std::string rig;                      // empty: none
  double max_publish_rate_hz = 1000.0;  // [1, 100000]
  double max_pull_n = 10.0;             // [0, 1000]
  std::vector<double> position_m = {0.0, 0.0, 0.0};

  void validate() const {
    require_in_range("real_time_factor", real_time_factor, {0.0, 1000.0});
    require_in_range("surface_rate_hz", surface_rate_hz, {0.0, 1000.0, true});
    require_in_range("skin_opacity", skin_opacity, {0.0, 1.0});
    require_in_range("max_publish_rate_hz", max_publish_rate_hz, {1.0, 1.0e5});
    require_in_range("max_pull_n", max_pull_n, {0.0, 1000.0});
    require_solver(solver);
    if (position_m.size() != 3 ||
        !std::all_of(position_m.begin(), position_m.end(), [](double x) { return std::abs(x) <= 1e3; }))
      throw std::invalid_argument("position_m: must be three numbers [m] in [-1000, 1000]");
    if (!publish_clock && real_time_factor != 1.0) {
      throw std::invalid_argument("real_time_factor: " + std::to_string(real_time_factor) +
                                  " is not 1, as it has to be where publish_clock is false");
    }
  }
};

// Throws std::invalid_argument naming the parameter.
inline SimulatorOptions read_options(const ros::NodeHandle& node) {
  SimulatorOptions options;
  if (!read_parameter(node, "scene", options.scene))
    throw std::invalid_argument("scene: missing; give the path of a scene");
  read_parameter(node, "solver", options.solver);
  read_parameter(node, "real_time_factor", options.real_time_factor);
  read_parameter(node, "start_at_rest", options.start_at_rest);
  read_parameter(node, "surface_rate_hz", options.surface_rate_hz);
  read_parameter(node, "skin_opacity", options.skin_opacity);
  read_parameter(node, "publish_clock", options.publish_clock);
  read_parameter(node, "rig", options.rig);
  read_parameter(node, "max_publish_rate_hz", options.max_publish_rate_hz);
  read_parameter(node, "max_pull_n", options.max_pull_n);
  read_parameter(node, "position_m", options.position_m);
  options.validate();
  return options;
}

}  // namespace soft_robot_lab
