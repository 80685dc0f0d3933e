// SPDX-License-Identifier: BSD-3-Clause
// How a scene's markers go on moving while commands are held.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/control/identification/fit_model.h"

namespace soft_robot_lab {

// One held command: where its markers were.
struct SimulatedHold {
  std::vector<double> times_s;              // since the command, rising from 0
  std::vector<Eigen::Matrix3Xd> markers_m;  // as the scene lists them
  double arrived_s = 0.0;                   // when its drives stood

  Eigen::Vector3d at(int marker, double time_s) const;  // linearly between steps
  Eigen::Vector3d mean(int marker, double from_s, double to_s) const;
};

// Of all poses, one after the other, from rest; in the scene's own steps until the drives have stood for a while, then
// of 0.25 s. Throws std::runtime_error where a step does not converge.
std::vector<SimulatedHold> simulate_holds(const std::string& scene, const SceneOptions& options,
                                          const std::vector<MeasuredPose>& poses,
                                          const std::map<std::string, double>& backlash_m);

}  // namespace soft_robot_lab
