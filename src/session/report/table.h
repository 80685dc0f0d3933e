// SPDX-License-Identifier: BSD-3-Clause
// A table of numbers and words, for a terminal, a file or a page.
#pragma once

#include <string>
#include <variant>
#include <vector>

namespace soft_robot_lab {

struct TableColumn {
  std::string name;  // with the unit: "sag [mm]"
  int digits = 4;    // significant ones, where numbers are printed
};
using TableCell = std::variant<double, std::string>;  // "" for nothing

struct Table {
  std::vector<TableColumn> columns;
  std::vector<std::vector<TableCell>> rows;
};

}  // namespace soft_robot_lab
