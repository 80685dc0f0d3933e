// SPDX-License-Identifier: BSD-3-Clause
#include "reach_targets.h"

#include <limits>
#include <random>

#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

// Evenly in the box. The engine's numbers are those of the C++ standard, so that every machine draws the same.
std::vector<ReachTarget> draw(const YamlNode& node) {
  const int count = node.integer("count", 1, 1000);
  std::mt19937 engine(static_cast<unsigned int>(node.integer("seed", 0, std::numeric_limits<int>::max())));
  const Eigen::Vector3d min_m = node.vector3("min_m"), max_m = node.vector3("max_m");
  if ((min_m.array() > max_m.array()).any()) node.fail("min_m must not be above max_m");
  const Eigen::Vector3d center_m = node.vector3("center_m");
  const double away_m = node.number("from_center_m", AllowedRange::not_negative());
  if ((min_m - center_m).cwiseAbs().cwiseMax((max_m - center_m).cwiseAbs()).norm() <= away_m)
    node.fail("from_center_m: the box has no such places");
  std::vector<ReachTarget> targets;
  while (static_cast<int>(targets.size()) < count) {
    Eigen::Vector3d position_m = min_m;
    for (int axis = 0; axis < 3; ++axis) {
      if (max_m[axis] == min_m[axis]) continue;
      position_m[axis] += (max_m[axis] - min_m[axis]) * (engine() / 4294967296.0);
    }
    if ((position_m - center_m).norm() >= away_m) targets.push_back({std::to_string(targets.size() + 1), position_m});
  }
  return targets;
}

}  // namespace

ReachTargets read_reach_targets(const std::string& file, const std::string& config_folder) {
  const YamlNode node = YamlNode::load_file(file);
  ReachTargets reach;
  reach.robot = config_folder + "/" + node.text("robot");
  reach.marker = node.text("marker");
  reach.targets = draw(node);
  node.require_all_read();
  return reach;
}

HangingRobot hang(const ReachTargets& reach, const ExperimentContext& context) {
  HangingRobot robot{load_scene(reach.robot, context.scene_options()), {}};
  const SolveReport report = robot.scene.simulation->solve_equilibrium();
  if (!report.converged) throw std::runtime_error(reach.robot + ": no rest state: " + report.message);
  robot.hanging = robot.scene.simulation->state();
  return robot;
}

}  // namespace soft_robot_lab
