// SPDX-License-Identifier: BSD-3-Clause
// Places that a robot's marker reaches for from hanging, drawn by a fixed seed: the same for every experiment that
// reads the same settings.
#pragma once

#include <string>
#include <vector>

#include "experiment.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

struct ReachTarget {
  std::string name;
  Eigen::Vector3d position_m;
};

struct ReachTargets {
  std::string robot, marker;
  std::vector<ReachTarget> targets;
};

// robot: robots/hammerbot/robot.yaml     # below the package's config/
// marker: tip
// count: 10
// seed: 1
// min_m, max_m: [x, y, z]          # a box; where both are the same, that coordinate is fixed
// center_m: [x, y, z]
// from_center_m: 0.025             # no place is nearer to it
ReachTargets read_reach_targets(const std::string& file, const std::string& config_folder);

// The robot, hanging at rest.
struct HangingRobot {
  Scene scene;
  SimulationState hanging;
};
HangingRobot hang(const ReachTargets& reach, const ExperimentContext& context);

}  // namespace soft_robot_lab
