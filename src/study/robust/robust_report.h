// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "random_robots.h"

namespace soft_robot_lab {

// Mean and quantiles of distances, in lines. Robots without rest are counted apart.
std::string robust_summary(const std::vector<double>& distances_m);

// FOLDER/robots.csv (a row a robot: its values, its distance) and report.html with quantiles, a histogram, and the
// distance over each value. Throws as write_file and write_plot do.
void write_robust_report(const Randomisation& randomisation, const std::vector<RandomRobot>& robots,
                         const std::vector<double>& distances_m, const std::string& folder);

}  // namespace soft_robot_lab
