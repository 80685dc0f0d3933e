// SPDX-License-Identifier: BSD-3-Clause
// Reference solutions (config/reference): CSV with one line of column names. SI; a column's name ends with its unit.
#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace soft_robot_lab {

// One row, by column name. Throws std::out_of_range for an unknown column, std::invalid_argument for no number.
class ReferenceRow {
 public:
  explicit ReferenceRow(std::map<std::string, std::string> cells) : cells_(std::move(cells)) {}
  const std::string& text(const std::string& column) const { return cells_.at(column); }
  double number(const std::string& column) const { return std::stod(text(column)); }

 private:
  std::map<std::string, std::string> cells_;
};

// Throws std::runtime_error where there is no such table.
inline std::vector<ReferenceRow> read_reference(const std::string& folder, const std::string& name) {
  std::ifstream file(folder + "/" + name + ".csv");
  const auto cells_of = [](const std::string& line) {
    std::istringstream fields(line.substr(0, line.find('\r')));
    std::vector<std::string> cells;
    for (std::string cell; std::getline(fields, cell, ',');) cells.push_back(cell);
    return cells;
  };
  std::string line;
  if (!std::getline(file, line)) throw std::runtime_error("no reference table " + name + " in " + folder);
  const std::vector<std::string> columns = cells_of(line);
  std::vector<ReferenceRow> rows;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = cells_of(line);
    std::map<std::string, std::string> row;
    for (std::size_t i = 0; i < columns.size(); ++i) row[columns[i]] = cells.at(i);
    rows.emplace_back(std::move(row));
  }
  return rows;
}

}  // namespace soft_robot_lab
