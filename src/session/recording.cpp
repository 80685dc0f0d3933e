// SPDX-License-Identifier: BSD-3-Clause
#include "recording.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <utility>

namespace soft_robot_lab {
namespace {

std::string tenths(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

std::vector<std::string> names_of(const std::vector<MotorReading>& motors) {
  std::vector<std::string> names;
  for (const MotorReading& motor : motors) names.push_back(motor.name);
  return names;
}

}  // namespace

void Recording::add_commands(const std::vector<std::string>& names, const std::vector<double>& values, double time_s) {
  if (!commands.empty() && time_s < commands.back().time_s) return;
  std::map<std::string, double> all = commands.empty() ? std::map<std::string, double>{} : commands.back().values;
  for (size_t i = 0; i < names.size() && i < values.size(); ++i) all[names[i]] = values[i];
  if (commands.empty() || all != commands.back().values) commands.push_back({time_s, std::move(all)});
}

void Recording::add_motors(const std::vector<MotorReading>& motors, double time_s) {
  if (!reached.empty() && time_s < reached.back().time_s) return;
  std::map<std::string, double> values;
  for (const MotorReading& motor : motors)
    if (motor.known && !motor.moving) values[motor.name] = motor.value;
  if (reached.empty() || values != reached.back().values) reached.push_back({time_s, std::move(values)});
  note_events(motors, time_s);
}

// Before the first command nothing is spoilt: there the rig is linked and set to zero.
void Recording::note_events(const std::vector<MotorReading>& motors, double time_s) {
  constexpr double most_steps = 8.0;  // that a motor takes between two states of one that stands
  const bool comparable = !commands.empty() && names_of(motors) == names_of(motors_);
  for (size_t i = 0; comparable && i < motors.size(); ++i) {
    const MotorReading &before = motors_[i], &now = motors[i];
    const bool stood = !now.moving && !before.moving;
    if (before.known && !now.known) {
      events.push_back({time_s, now.name + " does not know where it is" + (now.fault.empty() ? "" : ": " + now.fault)});
    } else if (stood && now.position_steps == 0.0 && std::abs(before.position_steps) > most_steps) {
      events.push_back({time_s, now.name + " was set to zero"});
    }
  }
  motors_ = motors;
}

void Recording::add_measured(ObservedMarkers markers) {
  if (measured.empty() || markers.time_s > measured.back().time_s) measured.push_back(std::move(markers));
}

UsablePart usable_part(const Recording& recording, std::optional<double> from_s, std::optional<double> to_s) {
  UsablePart part{recording, {}};
  Recording& kept = part.recording;
  if (kept.measured.empty()) return part;
  const double start_s = kept.measured.front().time_s, last_s = kept.measured.back().time_s;
  const double first_s = start_s + from_s.value_or(0.0);
  double end_s = to_s ? start_s + *to_s : last_s;
  const auto event = std::find_if(kept.events.begin(), kept.events.end(),
                                  [&](const RecordedEvent& one) { return one.time_s > first_s; });
  const bool spoilt = event != kept.events.end() && event->time_s <= end_s;
  if (spoilt && !to_s) end_s = event->time_s;
  if (spoilt) part.note = tenths(event->time_s - start_s) + " s: " + event->text;
  if (from_s || end_s < last_s)
    part.note = "used from " + tenths(first_s - start_s) + " s to " + tenths(end_s - start_s) + " s of " +
                tenths(last_s - start_s) + " s" + (spoilt ? "; at " + part.note : "");
  const auto outside = [&](const ObservedMarkers& at) { return at.time_s < first_s || at.time_s > end_s; };
  kept.measured.erase(std::remove_if(kept.measured.begin(), kept.measured.end(), outside), kept.measured.end());
  if (kept.measured.empty())
    throw std::invalid_argument("no markers were tracked from " + tenths(first_s - start_s) + " s to " +
                                tenths(end_s - start_s) + " s; the recording has " + tenths(last_s - start_s) + " s" +
                                (part.note.empty() ? "" : " (" + part.note + ")"));
  return part;
}

}  // namespace soft_robot_lab
