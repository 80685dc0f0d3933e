// SPDX-License-Identifier: BSD-3-Clause
#include "actuator_values.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "settings/words.h"

namespace soft_robot_lab {
namespace {

std::string text_of(double value, int decimals, const std::string& unit) {
  return format_fixed(value, decimals) + (unit.empty() ? "" : " " + unit);
}

double rounded(double value, int decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::round(value * scale) / scale;
}

// As people say it, and how much of the command's unit that is.
std::pair<std::string, double> shown_unit(const std::string& unit, double largest) {
  if (unit == "1") return {"", 1.0};
  if (unit == "m") return {"mm", 1e-3};
  if (unit == "Pa" && largest >= 1e3) return {"kPa", 1e3};
  return {unit, 1.0};
}

// A slider has 200 to 2000 positions; a typed number is ten times as fine.
ActuatorRow row_of(const ActuatorRanges& ranges, std::size_t i) {
  ActuatorRow row;
  row.name = ranges.names[i];
  std::tie(row.unit, row.command_per_unit) =
      shown_unit(ranges.units[i], std::max(std::abs(ranges.mins[i]), std::abs(ranges.maxs[i])));
  row.rest = ranges.rests[i] / row.command_per_unit;
  row.min = ranges.mins[i] / row.command_per_unit;
  row.max = ranges.maxs[i] / row.command_per_unit;
  if (!std::isfinite(row.rest) || !std::isfinite(row.min) || !std::isfinite(row.max) || !(row.max > row.min))
    throw std::invalid_argument("ranges: '" + row.name + "' has no finite range");
  const int exponent = static_cast<int>(std::floor(std::log10((row.max - row.min) / 200.0)));
  row.step = std::pow(10.0, exponent);
  row.decimals = std::clamp(1 - exponent, 0, 9);
  row.shown = row.rest;
  return row;
}

// Tension, or pressure and volume.
std::map<std::string, std::string> readings_of(const ActuatorState& state) {
  std::map<std::string, std::string> readings;
  for (const CableState& cable : state.cables) readings[cable.name] = text_of(cable.tension_n, 2, "N");
  for (const ChamberState& chamber : state.chambers)
    readings[chamber.name] =
        text_of(1e-3 * chamber.gauge_pressure_pa, 2, "kPa") + ", " + text_of(1e6 * chamber.volume_m3, 2, "ml");
  return readings;
}

}  // namespace

int ActuatorRow::positions() const { return static_cast<int>(std::ceil((max - min) / step - 1e-6)) + 1; }

int ActuatorRow::position_of(double value) const { return static_cast<int>(std::lround((value - min) / step)); }

double ActuatorRow::value_at(int slider_position) const {
  return slider_position >= positions() - 1 ? max : min + slider_position * step;
}

void ActuatorValues::set_ranges(const ActuatorRanges& ranges) {
  rows_.clear();
  edits_.clear();
  commands_.clear();
  reached_.clear();
  ++revision_;
  const std::size_t count = ranges.names.size();
  for (const std::size_t size : {ranges.units.size(), ranges.rests.size(), ranges.mins.size(), ranges.maxs.size()})
    if (size != count) throw std::invalid_argument("ranges: lists of different lengths");
  std::vector<ActuatorRow> rows;
  for (std::size_t i = 0; i < count; ++i) rows.push_back(row_of(ranges, i));
  rows_ = std::move(rows);
}

ActuatorRow* ActuatorValues::find(const std::string& name) {
  const auto found = std::find_if(rows_.begin(), rows_.end(), [&](const ActuatorRow& row) { return row.name == name; });
  return found == rows_.end() ? nullptr : &*found;
}

bool ActuatorValues::follow(ActuatorRow& row, double command, double now_s) {
  commands_[row.name] = command;
  const auto edit = edits_.find(row.name);
  if (edit != edits_.end()) {
    const bool holds = edit->second.sent && command == edit->second.command;
    if (!holds && now_s - edit->second.since_s < timeout_s) return false;
    edits_.erase(edit);
  }
  const double before = row.shown;
  row.shown = rounded(command / row.command_per_unit, row.decimals);
  return row.shown != before;
}

bool ActuatorValues::add_state(const ActuatorState& state, double now_s) {
  const std::size_t count = state.names.size();
  if (state.commands.size() != count || state.actuated_commands.size() != count) return false;
  const std::map<std::string, std::string> readings = readings_of(state);
  bool changed = false;
  for (std::size_t i = 0; i < count; ++i) {
    ActuatorRow* row = find(state.names[i]);
    if (row == nullptr || !std::isfinite(state.commands[i]) || !std::isfinite(state.actuated_commands[i])) continue;
    changed = follow(*row, state.commands[i], now_s) || changed;
    const double reached = state.actuated_commands[i] / row->command_per_unit;
    reached_[row->name] = reached;
    std::string measured = text_of(reached, std::max(0, row->decimals - 1), row->unit);
    if (const auto reading = readings.find(row->name); reading != readings.end()) measured += ", " + reading->second;
    changed = changed || measured != row->measured;
    row->measured = measured;
  }
  return changed;
}

void ActuatorValues::edit(const std::string& name, double value, double now_s) {
  ActuatorRow* row = find(name);
  if (row == nullptr || !std::isfinite(value)) return;
  const double next = std::clamp(rounded(value, row->decimals), row->min, row->max);
  if (next == row->shown) return;
  row->shown = next;
  edits_[name] = {row->command(), now_s, false};
}

void ActuatorValues::edit_all_to_rest(double now_s) {
  for (const ActuatorRow& row : std::vector<ActuatorRow>(rows_)) edit(row.name, row.rest, now_s);
}

void ActuatorValues::edit_all_to_reached(double now_s) {
  for (const auto& [name, value] : reached_) edit(name, value, now_s);
}

ActuatorCommand ActuatorValues::take_command() {
  ActuatorCommand command;
  for (auto& [name, edit] : edits_) {
    if (edit.sent) continue;
    edit.sent = true;
    command.names.push_back(name);
    command.values.push_back(edit.command);
  }
  return command;
}

}  // namespace soft_robot_lab
