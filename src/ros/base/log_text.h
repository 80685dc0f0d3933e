// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace soft_robot_lab {

// What was refused, for the log: what it quotes may be long, and written by anybody. Cut in the middle, control
// characters replaced.
std::string log_text(const std::string& text);

}  // namespace soft_robot_lab
