// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <string>

namespace soft_robot_lab {

// What was refused, for the log: what it quotes may be long, and written by anybody. Cut in the middle, control
// characters replaced.
std::string log_text(const std::string& text);

// Why a request is refused, for its answer: reason_of(), cut in the middle where it is longer than any of ours.
std::string answer_text(const std::exception& error);

}  // namespace soft_robot_lab
