// SPDX-License-Identifier: BSD-3-Clause
// The cells of the chart of stability as a table: CSV, names and messages quoted, without quotation marks in them.
#include <algorithm>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "stability.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kHeader =
    "body,method,case,default,outcome,solves,failed_solves,off_m,cpu_s,closure,integrator,message";
constexpr std::size_t kColumns = 12;

std::string quoted(std::string text) {
  std::replace(text.begin(), text.end(), '"', '\'');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return "\"" + text + "\"";
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields(1);
  bool inside = false;
  for (const char c : line) {
    if (c == '"') {
      inside = !inside;
    } else if (c == ',' && !inside) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

std::string share(const std::optional<double>& number) {
  if (!number) return "";
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << *number;
  return text.str();
}

// False where it is no number; an empty field is none.
bool read_share(const std::string& field, std::optional<double>& number) {
  if (field.empty()) return true;
  std::istringstream text(field);
  text.imbue(std::locale::classic());
  return static_cast<bool>(text >> number.emplace());
}

Outcome outcome_named(const std::string& name) {
  for (int i = 0; i < kOutcomes; ++i)
    if (name == name_of(static_cast<Outcome>(i))) return static_cast<Outcome>(i);
  throw std::invalid_argument("unknown outcome '" + name + "'");
}

}  // namespace

std::string stability_csv(const std::vector<StabilityCell>& cells) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << kHeader << "\n";
  for (const StabilityCell& cell : cells)
    text << quoted(cell.body) << "," << quoted(cell.method) << "," << quoted(cell.hard_case) << "," << cell.ours << ","
         << name_of(cell.outcome) << "," << cell.solves << "," << cell.failed_solves << "," << cell.off_m << ","
         << cell.cpu_s << "," << share(cell.closure) << "," << share(cell.integrator) << "," << quoted(cell.message)
         << "\n";
  return text.str();
}

std::vector<StabilityCell> read_stability_csv(std::istream& file) {
  std::vector<StabilityCell> cells;
  std::string line;
  if (!std::getline(file, line) || line != kHeader)
    throw std::invalid_argument("line 1 must be '" + std::string(kHeader) + "'");
  for (int number = 2; std::getline(file, line); ++number) {
    const std::vector<std::string> fields = split(line);
    if (fields.size() != kColumns)
      throw std::invalid_argument("line " + std::to_string(number) + " has " + std::to_string(fields.size()) +
                                  " fields, must have " + std::to_string(kColumns));
    StabilityCell cell;
    cell.body = fields[0];
    cell.method = fields[1];
    cell.hard_case = fields[2];
    cell.ours = fields[3] == "1";
    cell.outcome = outcome_named(fields[4]);
    std::istringstream numbers(fields[5] + " " + fields[6] + " " + fields[7] + " " + fields[8]);
    numbers.imbue(std::locale::classic());
    if (!(numbers >> cell.solves >> cell.failed_solves >> cell.off_m >> cell.cpu_s) ||
        !read_share(fields[9], cell.closure) || !read_share(fields[10], cell.integrator))
      throw std::invalid_argument("line " + std::to_string(number) + " has a bad number");
    cell.message = fields[11];
    cells.push_back(cell);
  }
  return cells;
}

}  // namespace soft_robot_lab
