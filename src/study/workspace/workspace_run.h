// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "study/sweeps/journal.h"
#include "study/sweeps/results_table.h"
#include "workspace_plan.h"

namespace soft_robot_lab {

struct WorkspaceProgress {
  std::size_t points = 0, done = 0;  // those of earlier runs are done
  std::size_t failed = 0;            // of this run
};

// Finds what the journal does not know yet, and writes each point into it. `report` is called after each; false: stop.
void run_workspace(const WorkspacePlan& plan, const std::shared_ptr<const Model>& model, int threads, Journal& journal,
                   const std::function<bool(const WorkspaceProgress&)>& report);

// Of one point, as the journal has them; nothing where it is not found yet, or has no rest state.
struct Reached {
  Eigen::Vector3d marker_m;
  Eigen::MatrixXd jacobian_m;
};
std::optional<Reached> reached(const WorkspacePlan& plan, const StudyTask& task, const Journal& journal);

// The journal's points, with a column `folded`: whether the robot is of another shape at a neighbour's commands.
ResultsTable workspace_table(const WorkspacePlan& plan, const Journal& journal);

}  // namespace soft_robot_lab
