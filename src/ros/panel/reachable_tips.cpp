// SPDX-License-Identifier: BSD-3-Clause
#include "reachable_tips.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "settings/csv_cells.h"
#include "settings/limits.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

using Cells = std::vector<std::string>;

class Columns {
 public:
  explicit Columns(Cells names) : names_(std::move(names)) {}

  std::size_t size() const { return names_.size(); }
  const std::string& name(std::size_t i) const { return names_[i]; }
  std::size_t index(const std::string& name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) throw std::invalid_argument("results.csv has no column '" + name + "'");
    return static_cast<std::size_t>(found - names_.begin());
  }
  std::vector<std::size_t> ending_with(const std::string& end) const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < names_.size(); ++i)
      if (names_[i].size() > end.size() && names_[i].compare(names_[i].size() - end.size(), end.size(), end) == 0)
        found.push_back(i);
    return found;
  }

 private:
  Cells names_;
};

double number(const std::string& cell) {
  const std::optional<double> value = parse_number<double>(cell);
  if (!value || !(std::abs(*value) <= limits::kNumber))
    throw std::invalid_argument("results.csv: '" + cell + "' is no number in [-1e12, 1e12]");
  return *value;
}

// The columns of what actuators work with: cables by tension, else chambers by pressure.
std::vector<std::size_t> effort_columns(const Columns& columns, std::string& title) {
  std::vector<std::size_t> found = columns.ending_with(".tension_n");
  title = found.empty() ? "gauge pressure [Pa]" : "tension [N]";
  if (found.empty()) found = columns.ending_with(".gauge_pressure_pa");
  if (found.empty()) title.clear();
  return found;
}

double largest(const Cells& row, const std::vector<std::size_t>& columns) {
  double most = 0.0;
  for (const std::size_t column : columns)
    if (!row[column].empty()) most = std::max(most, number(row[column]));
  return most;
}

}  // namespace

double TipQuantity::largest() const {
  double most = 1e-9;
  for (const double value : values) most = std::max(most, value);
  return most;
}

std::vector<TipQuantity> quantities_of(const ReachableTips& tips) {
  TipQuantity effort{tips.effort, {}}, motion{"least motion [mm]", {}};
  for (const ReachableTip& tip : tips.tips) {
    effort.values.push_back(tip.effort);
    motion.values.push_back(1e3 * tip.least_motion_m);
  }
  if (tips.effort.empty()) return {motion};
  return {effort, motion};
}

ReachableTips read_reachable_tips(const std::string& csv, const std::string& marker) {
  std::istringstream lines(csv);
  std::string line;
  if (!std::getline(lines, line)) throw std::invalid_argument("results.csv is empty");
  const Columns columns(csv_cells(line));
  const std::string place = "markers." + marker + ".position_m.";
  const std::size_t at[3] = {columns.index(place + "x"), columns.index(place + "y"), columns.index(place + "z")};
  const std::size_t task = columns.index("task"), state = columns.index("state");
  const std::size_t snapped = columns.index("snapped"), folded = columns.index("folded");
  const std::size_t motion = columns.index("least_singular_value_m");
  ReachableTips all;
  all.marker = marker;
  for (std::size_t i = task + 1; i < state; ++i) all.actuators.push_back(columns.name(i));
  const std::vector<std::size_t> efforts = effort_columns(columns, all.effort);
  while (std::getline(lines, line)) {
    const Cells row = csv_cells(line);
    if (row.size() != columns.size()) throw std::invalid_argument("results.csv: a row of another length");
    if (row[state] != "good") continue;
    ReachableTip tip;
    for (int axis = 0; axis < 3; ++axis) tip.position_m[axis] = number(row[at[axis]]);
    tip.effort = largest(row, efforts);
    tip.least_motion_m = number(row[motion]);
    tip.snaps = row[snapped] == "true" || row[folded] == "true";
    for (std::size_t i = task + 1; i < state; ++i) tip.commands.push_back(number(row[i]));
    all.tips.push_back(std::move(tip));
  }
  return all;
}

}  // namespace soft_robot_lab
