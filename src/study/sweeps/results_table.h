// SPDX-License-Identifier: BSD-3-Clause
// The outcomes of a study as a table: a row a task, in the tasks' order, whoever ran them and when.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "journal.h"
#include "task.h"

namespace soft_robot_lab {

// A result's values by name: markers.tip.position_m.x for triples, NAME[0] for other lists of up to 16 numbers or maps,
// as poses[0].final_distance_m, and NAME.count for lists of anything else. Times that a run took are left out, since
// they differ from run to run.
std::vector<std::pair<std::string, nlohmann::ordered_json>> flatten(const nlohmann::ordered_json& result);

struct ResultsTable {
  std::vector<std::string> parameters, results;              // names
  std::vector<std::vector<nlohmann::ordered_json>> columns;  // of the results, null where a task has none
  std::vector<std::string> states, reasons;                  // "" for tasks that were not run
  std::vector<StudyTask> tasks;

  bool all_good() const;

  // Of a column, NaN where it holds no number; truth counts as 1.
  std::vector<double> numbers(std::size_t result) const;
};

ResultsTable results_table(const StudySettings& study, const std::vector<StudyTask>& tasks, const Journal& journal);

// task, parameters, seed where there is one, state, reason, results.
std::string results_csv(const ResultsTable& table);

// A NumPy array with a named field of doubles for each parameter and each result that is a number: numpy.load(FILE).
std::string results_npy(const ResultsTable& table);

// Both into a folder, as results.csv and results.npy.
void write_results(const ResultsTable& table, const std::string& folder);

}  // namespace soft_robot_lab
