// SPDX-License-Identifier: BSD-3-Clause
#include "same_commands.h"

#include <algorithm>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

const std::string kContraction = "contraction of a cable [1]";
const std::string kPlunger = "plunger's travel [ml]";

std::string command_of(const MotorSettings& motor) { return motor.step_m > 0.0 ? kContraction : kPlunger; }

// A chamber's `volume_offset` counts as a plunger's travel: both are the air that a syringe presses in.
std::string command_of(const CommandLimits& limits, const ActuatorReading& reading) {
  if (reading.length_m && limits.unit == "1") return kContraction;
  if (reading.length_m && limits.unit == "m") return "length of a cable [m]";
  if (reading.length_m && limits.unit == "N") return "tension of a cable [N]";
  if (reading.volume_m3 && limits.unit == "ml") return kPlunger;
  if (reading.volume_m3 && limits.unit == "1") return "amount of gas, beta [1]";
  if (reading.volume_m3 && limits.unit == "Pa") return "gauge pressure [Pa]";
  return "command [" + limits.unit + "]";
}

}  // namespace

void require_same_commands(const Simulation& simulation, const std::string& scene_file, const RigSettings& rig,
                           const std::string& rig_file) {
  for (std::size_t i = 0; i < simulation.actuators().size(); ++i) {
    const Actuator& actuator = *simulation.actuators()[i];
    const auto motor = std::find_if(rig.motors.begin(), rig.motors.end(),
                                    [&](const MotorSettings& one) { return one.name == actuator.name(); });
    if (motor == rig.motors.end())
      throw std::invalid_argument(rig_file + " has no motor for '" + actuator.name() + "' of " + scene_file);
    const std::string here = command_of(actuator.limits(), simulation.actuator_state(static_cast<int>(i)));
    const std::string there = command_of(*motor);
    if (here != there)
      throw std::invalid_argument(scene_file + " takes the command of '" + actuator.name() + "' as the " + here + ", " +
                                  rig_file + " as the " + there + ": one command goes to both, so they must agree");
  }
}

}  // namespace soft_robot_lab
