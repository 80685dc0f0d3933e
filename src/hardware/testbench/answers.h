// SPDX-License-Identifier: BSD-3-Clause
// What the emulator's answers say.
#pragma once

#include <string>
#include <vector>

#include "rig_control.h"

namespace soft_robot_lab {

// The answer without its "ok"; throws std::invalid_argument for an error.
std::string unwrap(const std::string& command, const std::string& answer);
std::vector<ShaftTruth> read_shafts(const std::string& text);
std::vector<double> read_pressures(const std::string& text);

}  // namespace soft_robot_lab
