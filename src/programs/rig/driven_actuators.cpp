// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include "rig_texts.h"
#include "hardware/motor/wire.h"

namespace soft_robot_lab {
namespace {

constexpr double kMostContraction = 1.2;  // how far a spool lets a cable out
constexpr double kShareOfSyringe = 0.9;   // a shaft may overshoot, and stay within the robot's limits
constexpr double kShareOfPressure = 0.9;  // so may a pressure

struct Item {
  std::string section;
  YamlNode settings;
};

// Of all three lists, by name.
std::map<std::string, Item> items_of(const YamlNode& robot) {
  std::map<std::string, Item> items;
  for (const std::string section : {"cables", "chambers", "actuators"})
    for (const YamlNode& item : robot.optional_sequence(section)) items.insert({item.text("name"), {section, item}});
  return items;
}

void read_cable(const Item& item, const CommandLimits& limits, const ActuatorReading& reading, Driven& drive) {
  if (limits.unit != "1")
    item.settings.fail(
        "command: must be contraction: a motor of a rig turns a spool, and its command is a contraction");
  if (!item.settings.has("min_contraction"))
    item.settings.fail("min_contraction: missing; a motor needs a limit that the robot bears, in [0.05, 1]");
  drive.model = item.settings.text_or("model", "sliding");
  drive.rest_length_m = reading.rest_length_m.value();
  drive.min_command = limits.min;
  drive.max_command = std::min(limits.max, kMostContraction);
  drive.speed = item.settings.number_or("pull_speed_m_s", 0.0);
  drive.delayed = item.settings.number_or("pull_delay_s", 0.0) > 0.0;
  drive.friction_coefficient = item.settings.number_or("friction_coefficient", 0.0);
  drive.compliance_m_n = item.settings.number_or("compliance_m_n", 1e-5);
  drive.length_offset_m = item.settings.number_or("length_offset_m", 0.0);
}

void read_air(const Item& item, const CommandLimits& limits, Driven& drive) {
  if (!item.settings.has("max_gauge_pressure_pa"))
    item.settings.fail("max_gauge_pressure_pa: missing; a pressure channel needs a limit that the robot bears");
  drive.air = true;
  drive.max_command = kShareOfPressure * limits.max;
}

void read_chamber(const Item& item, const CommandLimits& limits, Driven& drive) {
  if (limits.unit == "Pa") return read_air(item, limits, drive);
  if (limits.unit != "ml")
    item.settings.fail(
        "command: must be syringe, volume_offset or gauge_pressure: a motor of a rig moves a plunger, and its command "
        "is in ml, or a pressure channel fills the chamber");
  if (!item.settings.has("syringe_volume_ml") && !item.settings.has("max_offset_ml"))
    item.settings.fail("max_offset_ml: missing; a motor needs a limit that the robot bears, at least 0");
  drive.syringe = true;
  drive.min_command = kShareOfSyringe * limits.min;
  drive.max_command = kShareOfSyringe * limits.max;
  drive.speed = item.settings.number_or("flow_ml_s", 0.0);
  drive.tube_volume_ml = item.settings.number_or("tube_volume_ml", 0.0);
}

// One board has the one kind or the other.
void require_one_kind(const YamlNode& robot, const std::vector<Driven>& drives) {
  const auto air = static_cast<std::size_t>(
      std::count_if(drives.begin(), drives.end(), [](const Driven& drive) { return drive.air; }));
  if (air != 0 && air != drives.size())
    throw std::invalid_argument(robot.source() + ": has chambers by gauge_pressure beside other actuators; a rig's " +
                                "board drives motors or pressure channels, not both");
  if (air > wire::max_channels)
    throw std::invalid_argument(robot.source() + ": has " + std::to_string(air) + " chambers; a rig's board has 1 to " +
                                std::to_string(wire::max_channels) + " pressure channels");
}

}  // namespace

std::vector<Driven> driven_actuators(const YamlNode& robot, const Simulation& simulation) {
  const std::map<std::string, Item> items = items_of(robot);
  const std::size_t count = simulation.actuators().size();
  if (count == 0 || count > wire::max_motors)
    throw std::invalid_argument(robot.source() + ": has " + std::to_string(count) +
                                " actuators; a rig's board drives 1 to " + std::to_string(wire::max_motors));
  std::vector<Driven> drives;
  for (std::size_t i = 0; i < count; ++i) {
    const Actuator& actuator = *simulation.actuators()[i];
    const ActuatorReading reading = simulation.actuator_state(static_cast<int>(i));
    const Item& item = items.at(actuator.name());
    Driven drive;
    drive.name = actuator.name();
    drive.section = item.section;
    if (reading.length_m) {
      read_cable(item, actuator.limits(), reading, drive);
    } else if (reading.volume_m3) {
      read_chamber(item, actuator.limits(), drive);
    } else {
      item.settings.fail("is neither a cable nor a chamber; motors of a rig pull cables and press syringes");
    }
    drives.push_back(drive);
  }
  require_one_kind(robot, drives);
  return drives;
}

}  // namespace soft_robot_lab
