// SPDX-License-Identifier: BSD-3-Clause
// A workspace for a terminal and a browser.
#pragma once

#include <string>

#include "study/sweeps/results_table.h"
#include "workspace_plan.h"

namespace soft_robot_lab {

// Where the marker goes, how hard its actuators work at most, and where it snaps, in a few lines.
std::string workspace_summary(const WorkspacePlan& plan, const ResultsTable& table);

// Writes FOLDER/workspace.html with its pictures: the marker's places seen along each axis that it does not only move
// along, coloured by the hardest working actuator; with two actuators, maps over their commands. Throws as write_plot.
void write_workspace_report(const WorkspacePlan& plan, const ResultsTable& table, const std::string& folder);

}  // namespace soft_robot_lab
