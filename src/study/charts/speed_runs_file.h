// SPDX-License-Identifier: BSD-3-Clause
// Measured runs as a file, so that long measurements can be split, continued and drawn again.
#pragma once

#include <string>
#include <vector>

#include "speed_measurement.h"

namespace soft_robot_lab {

// Both throw std::runtime_error naming the file.
void write_runs(const std::string& path, const std::vector<SpeedRun>& runs);
std::vector<SpeedRun> read_runs(const std::string& path);

}  // namespace soft_robot_lab
