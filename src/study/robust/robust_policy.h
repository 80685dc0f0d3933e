// SPDX-License-Identifier: BSD-3-Clause
// A policy that does well on many robots at a time, and how well a policy does on each.
#pragma once

#include <optional>

#include "random_robots.h"
#include "soft_robot_lab/control/find_policy.h"

namespace soft_robot_lab {

// Of each robot its distance at the end of the policy, as cameras believe: root of the goals' weighted mean square.
// Infinite where it finds no rest. The robots are at rest before and after.
std::vector<double> distances_m(std::vector<RandomRobot>& robots, const CommandPolicy& policy, const Pose& pose);

struct RobustOptions {
  std::optional<double> quantile;   // (0, 1) of the distances; absent: their mean square
  OptimiserOptions optimiser = {};  // of the mean square
  int generations = 12;             // of the search for the quantile
};

// Commands for one pose, from rest: first for the least mean square, by derivatives; then near these for the least
// quantile, by CMA-ES. Throws std::invalid_argument: more than one pose, settings out of range.
PolicyAnswer find_robust_policy(std::vector<RandomRobot>& robots, const PolicyTask& task, const RobustOptions& options,
                                const ProgressCallback& progress = {});

}  // namespace soft_robot_lab
