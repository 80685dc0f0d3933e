// SPDX-License-Identifier: BSD-3-Clause
#include "drive_play.h"

#include <algorithm>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

// Of a metre of cable, in units of its command.
double command_per_metre(const Simulation& simulation, int actuator) {
  const ActuatorReading reading = simulation.actuator_state(actuator);
  const std::string& unit = simulation.actuators()[static_cast<std::size_t>(actuator)]->limits().unit;
  if (reading.rest_length_m && unit == "1") return 1.0 / *reading.rest_length_m;
  if (reading.rest_length_m && unit == "m") return 1.0;
  throw std::invalid_argument("backlash_m: '" + reading.name + "' is not commanded by length");
}

}  // namespace

DrivePlay::DrivePlay(const Simulation& simulation, const std::map<std::string, double>& backlash_m)
    : plays_(simulation.actuators().size(), 0.0), slopes_(plays_.size(), 0.0) {
  for (const auto& actuator : simulation.actuators()) least_.push_back(actuator->limits().min);
  for (const auto& [name, play_m] : backlash_m) {
    const int actuator = simulation.actuator_index(name);
    plays_[static_cast<std::size_t>(actuator)] = play_m * command_per_metre(simulation, actuator);
  }
}

DriveEnds DrivePlay::go(const std::vector<double>& commands) {
  if (ends_.empty()) ends_ = commands;
  for (std::size_t i = 0; i < ends_.size(); ++i) {
    const double shortest = std::max(least_[i], commands[i] - plays_[i]), before = ends_[i];
    ends_[i] = std::clamp(before, shortest, commands[i]);
    if (ends_[i] < before) slopes_[i] = 0.0;
    if (ends_[i] > before) slopes_[i] = -1.0;
  }
  return {ends_, slopes_};
}

}  // namespace soft_robot_lab
