// SPDX-License-Identifier: BSD-3-Clause
#include "same_commands.h"

#include <algorithm>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

const std::string kContraction = "contraction of a cable [1]";
const std::string kPlunger = "plunger's travel [ml]";

const std::string kPressure = "gauge pressure [Pa]";

// Of the drive with this name; empty where there is none.
std::string command_of(const RigSettings& rig, const std::string& name) {
  const auto is_it = [&name](const DriveLimits& one) { return one.name == name; };
  if (std::any_of(rig.channels.begin(), rig.channels.end(), is_it)) return kPressure;
  const auto motor = std::find_if(rig.motors.begin(), rig.motors.end(), is_it);
  if (motor == rig.motors.end()) return "";
  return motor->step_m > 0.0 ? kContraction : kPlunger;
}

// A chamber's `volume_offset` counts as a plunger's travel: both are the air that a syringe presses in.
std::string command_of(const CommandLimits& limits, const ActuatorReading& reading) {
  if (reading.length_m && limits.unit == "1") return kContraction;
  if (reading.length_m && limits.unit == "m") return "length of a cable [m]";
  if (reading.length_m && limits.unit == "N") return "tension of a cable [N]";
  if (reading.volume_m3 && limits.unit == "ml") return kPlunger;
  if (reading.volume_m3 && limits.unit == "1") return "amount of gas, beta [1]";
  if (reading.volume_m3 && limits.unit == "Pa") return kPressure;
  return "command [" + limits.unit + "]";
}

}  // namespace

void require_same_commands(const Simulation& simulation, const std::string& scene_file, const RigSettings& rig,
                           const std::string& rig_file) {
  for (std::size_t i = 0; i < simulation.actuators().size(); ++i) {
    const Actuator& actuator = *simulation.actuators()[i];
    const std::string there = command_of(rig, actuator.name());
    if (there.empty())
      throw std::invalid_argument(rig_file + (rig.channels.empty() ? " has no motor for '" : " has no channel for '") +
                                  actuator.name() + "' of " + scene_file);
    const std::string here = command_of(actuator.limits(), simulation.actuator_state(static_cast<int>(i)));
    if (here != there)
      throw std::invalid_argument(scene_file + " takes the command of '" + actuator.name() + "' as the " + here + ", " +
                                  rig_file + " as the " + there + ": one command goes to both, so they must agree");
  }
}

}  // namespace soft_robot_lab
