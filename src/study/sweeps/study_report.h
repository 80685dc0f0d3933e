// SPDX-License-Identifier: BSD-3-Clause
// A study's outcome for a browser and a terminal.
#pragma once

#include <string>

#include "results_table.h"
#include "task_runner.h"

namespace soft_robot_lab {

// Results to show: those that the study names, or the first few that vary over its tasks. Throws std::invalid_argument
// for a name that no task has.
std::vector<std::size_t> shown_results(const StudySettings& study, const ResultsTable& table);

// Least, mean and largest of each shown result, and the first failures with their reasons, in lines.
std::string study_summary(const StudySettings& study, const ResultsTable& table);

// Writes FOLDER/report.html and its plots: each shown result over each parameter. Throws as write_plot does.
void write_study_report(const StudySettings& study, const ResultsTable& table, const std::string& folder);

}  // namespace soft_robot_lab
