// SPDX-License-Identifier: BSD-3-Clause
// Commands that users name, and those that shells elsewhere read.
#pragma once

#include <string>
#include <vector>

namespace soft_robot_lab {

std::vector<std::string> words_of(const std::string& command);  // between blanks

std::string shell_quoted(const std::string& text);  // as one word

// The program `study`, as it starts its own workers; the same place on all machines.
std::string study_program();

}  // namespace soft_robot_lab
