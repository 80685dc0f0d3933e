// The reference solutions in test/data/reference: CSV with one line of column names.
#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace soft_robot_lab {

// One row, by column name.
class ReferenceRow {
 public:
  explicit ReferenceRow(std::map<std::string, std::string> cells) : cells_(std::move(cells)) {}
  const std::string& text(const std::string& column) const { return cells_.at(column); }
  double number(const std::string& column) const { return std::stod(text(column)); }

 private:
  std::map<std::string, std::string> cells_;
};

inline std::vector<ReferenceRow> read_reference(const std::string& name) {
  std::ifstream file(std::string(SOFT_ROBOT_LAB_SOURCE) + "/test/data/reference/" + name + ".csv");
  const auto cells_of = [](const std::string& line) {
    std::istringstream fields(line.substr(0, line.find('\r')));
    std::vector<std::string> cells;
    for (std::string cell; std::getline(fields, cell, ',');) cells.push_back(cell);
    return cells;
  };
  std::string line;
  if (!std::getline(file, line)) throw std::runtime_error("no reference table " + name);
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
