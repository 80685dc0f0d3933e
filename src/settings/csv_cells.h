// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace soft_robot_lab {

// Of a line of a CSV file, without blanks at their ends. A cell in double quotes may hold commas and, doubled, quotes.
// A quote that nothing closes stays. A byte order mark of UTF-8 before the first cell, as office programs write it, is
// left out.
std::vector<std::string> csv_cells(const std::string& line);

}  // namespace soft_robot_lab
