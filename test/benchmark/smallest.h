// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

namespace soft_robot_lab {

// Of repetitions: the one that others' work on the machine disturbed least.
inline double smallest(const std::vector<double>& values) { return *std::min_element(values.begin(), values.end()); }

}  // namespace soft_robot_lab
