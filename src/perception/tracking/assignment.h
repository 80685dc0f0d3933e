// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// Gives each row at most one column and each column at most one row so that the sum of costs is least, where a row
// without a column costs `cost_of_none`: the Hungarian method (shortest augmenting paths, Jonker and Volgenant 1987).
// Infinite costs are never chosen. Returns the column of each row, or -1. Throws std::invalid_argument for NaN.
std::vector<int> assign(const Eigen::MatrixXd& costs, double cost_of_none);

}  // namespace soft_robot_lab
