// SPDX-License-Identifier: BSD-3-Clause
#include "ballooning.h"

#include <sstream>

namespace soft_robot_lab {
namespace {

constexpr double kGrown = 3.0;      // times the volume of the rest shape: walls that snap over enclose less
constexpr double kGrownNow = 1.15;  // times the volume of the last rest state

std::vector<ActuatorReading> readings_of(const SimulationParts& parts) {
  std::vector<ActuatorReading> readings;
  for (std::size_t i = 0; i < parts.actuators.size(); ++i) readings.push_back(parts.reading_of(i));
  return readings;
}

}  // namespace

Ballooning::Ballooning(const SimulationParts& parts) : at_rest_(readings_of(parts)) {}

std::string Ballooning::found(const SimulationParts& parts) const {
  for (std::size_t i = 0; i < at_rest_.size(); ++i) {
    const bool held_pressure = parts.actuators[i]->limits().unit == "Pa" && at_rest_[i].volume_m3;
    if (!held_pressure || *at_rest_[i].volume_m3 <= 0.0) continue;
    const double now_m3 = *parts.reading_of(i).volume_m3, times = now_m3 / *at_rest_[i].initial_volume_m3;
    if (times < kGrown || now_m3 < kGrownNow * *at_rest_[i].volume_m3) continue;
    std::ostringstream text;
    text << "chamber '" << at_rest_[i].name << "' has no rest state above "
         << at_rest_[i].gauge_pressure_pa.value_or(0.0) << " Pa nearby: it balloons, to " << times
         << " times its first volume; thicker walls hold more, and `command: volume_offset` or `syringe` sets its gas";
    return text.str();
  }
  return "";
}

}  // namespace soft_robot_lab
