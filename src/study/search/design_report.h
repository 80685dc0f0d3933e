// SPDX-License-Identifier: BSD-3-Clause
// What a search found, for a browser and for other programs.
#pragma once

#include <string>

#include "design_search.h"

namespace soft_robot_lab {

// designs.csv       all, as they were asked for: parameters, whether good and why not, objectives
// design_N.yaml     of each design of the Pareto front: the robot's file with its numbers
// report.html       the front with a picture of each, how it came about, what could not be cast and why
// `mesher` as in SceneOptions. Throws as write_file and write_plot do.
void write_search_report(const SearchSettings& search, const std::vector<Design>& designs, const std::string& folder,
                         const std::string& mesher = "");

// A line for each design of the front.
std::string search_summary(const SearchSettings& search, const std::vector<Design>& designs);

}  // namespace soft_robot_lab
