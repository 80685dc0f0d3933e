// SPDX-License-Identifier: BSD-3-Clause
// An experiment's outcome for a reader on a terminal, for a program, and for a browser.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "experiment.h"

namespace soft_robot_lab {

struct ExperimentReport {
  std::string name;
  ExperimentResult result;
  std::vector<PlotFiles> pictures;
};

// What the source reports, or that it has no such experiment: never empty.
std::string source_column(const ExperimentResult& result);

// Throws std::invalid_argument for a row that has more or fewer cells than there are columns.
void print_table(const Table& table, std::ostream& out);

// Title, table, paragraphs and files.
void print_report(const ExperimentReport& report, std::ostream& out);

// One experiment: {title, converged, message, source_reports, we_differ, we_find, table: [{column: value}], its numbers
// by their names, pictures}. Several: {name: that}.
std::string experiments_json(const std::vector<ExperimentReport>& reports);

// One page that holds its pictures, so that it can be sent as one file.
std::string experiments_html(const std::vector<ExperimentReport>& reports);

}  // namespace soft_robot_lab
