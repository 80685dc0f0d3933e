// SPDX-License-Identifier: BSD-3-Clause
// From a task to the problems of its poses.
#pragma once

#include "soft_robot_lab/control/find_policy.h"

namespace soft_robot_lab {

// Throws std::invalid_argument naming field, value and allowed range.
void require_task(const Simulation& simulation, const PolicyTask& task);

// The problem of one pose without its model, from the simulation's present commands. Throws std::invalid_argument where
// a largest rate keeps a command out of its bounds.
ReachProblem pose_problem(const Simulation& simulation, const PolicyTask& task, const Pose& pose);

// Leaves the simulation in this state with the commands found, where there is no time to play them.
void command_only(Simulation& simulation, const SimulationState& before, const std::vector<std::string>& names,
                  OptimisationSummary& summary);

std::vector<std::string> markers_of(const Pose& pose);

}  // namespace soft_robot_lab
