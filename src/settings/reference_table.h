// SPDX-License-Identifier: BSD-3-Clause
// Reference solutions (config/reference): CSV with one line of column names. SI; a column's name ends with its unit.
#pragma once

#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "csv_cells.h"
#include "words.h"

namespace soft_robot_lab {

// One row, by column name. Throws std::out_of_range for an unknown column, std::invalid_argument for no number.
class ReferenceRow {
 public:
  explicit ReferenceRow(std::map<std::string, std::string> cells) : cells_(std::move(cells)) {}
  const std::string& text(const std::string& column) const { return cells_.at(column); }
  double number(const std::string& column) const {
    if (const std::optional<double> value = parse_number<double>(text(column))) return *value;
    throw std::invalid_argument(column + ": '" + text(column) + "' is no number");
  }

 private:
  std::map<std::string, std::string> cells_;
};

// Throws std::runtime_error where there is no such table.
inline std::vector<ReferenceRow> read_reference(const std::string& folder, const std::string& name) {
  std::ifstream file(folder + "/" + name + ".csv");
  std::string line;
  if (!std::getline(file, line)) throw std::runtime_error("no reference table " + name + " in " + folder);
  const std::vector<std::string> columns = csv_cells(line);
  std::vector<ReferenceRow> rows;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = csv_cells(line);
    std::map<std::string, std::string> row;
    for (std::size_t i = 0; i < columns.size(); ++i) row[columns[i]] = cells.at(i);
    rows.emplace_back(std::move(row));
  }
  return rows;
}

}  // namespace soft_robot_lab
