// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "session/report/plot.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// A robot that hangs along z, by its markers from top to bottom: x or y, and z [mm].
inline Series marker_line(const Simulation& simulation, const std::vector<std::string>& markers,
                          const std::string& label, int axis = 0) {
  Series series{label, {}, {}};
  for (const std::string& name : markers) {
    const Eigen::Vector3d at_m = simulation.marker_position(simulation.marker_index(name));
    series.x.push_back(1e3 * at_m[axis]);
    series.y.push_back(1e3 * at_m.z());
  }
  return series;
}

}  // namespace soft_robot_lab
