// SPDX-License-Identifier: BSD-3-Clause
#include "ballooning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "descent.h"

namespace soft_robot_lab {
namespace {

constexpr double kGrown = 3.0;      // times the volume of the rest shape: walls that snap over enclose less
constexpr double kGrownNow = 1.15;  // times the volume of the last rest state

constexpr double kMoreGas = 1.15;  // at a time
constexpr double kLeastMoreGas = 1.01;
constexpr int kMostGas = 40;           // times that
constexpr double kNearlyThere = 0.99;  // of the pressure that is asked for: a search at that pressure decides
constexpr double kFallen = 0.998;      // of the highest pressure: it is past it

// Of a parabola through three pressures, one after the other, of which the middle one is the highest.
double top_of(double before_pa, double highest_pa, double after_pa) {
  const double bend_pa = 2.0 * highest_pa - before_pa - after_pa, slope_pa = after_pa - before_pa;
  return highest_pa + (bend_pa > 0.0 ? slope_pa * slope_pa / (8.0 * bend_pa) : 0.0);
}

std::string text_of(const ActuatorReading& chamber, double highest_pa, double times) {
  std::ostringstream text;
  text << "chamber '" << chamber.name << "' has no rest state above " << highest_pa << " Pa nearby: it balloons, to "
       << times
       << " times its first volume; thicker walls or threads around it (`fibres`) hold more, and `command: "
          "volume_offset` or `syringe` sets its gas";
  return text.str();
}

bool under_held_pressure(const Actuator& actuator, const ActuatorReading& chamber) {
  return actuator.limits().unit == "Pa" && chamber.volume_m3 && *chamber.volume_m3 > 0.0;
}

std::vector<ActuatorReading> readings_of(const SimulationParts& parts) {
  std::vector<ActuatorReading> readings;
  for (std::size_t i = 0; i < parts.actuators.size(); ++i) readings.push_back(parts.reading_of(i));
  return readings;
}

}  // namespace

Ballooning::Ballooning(const SimulationParts& parts) : at_rest_(readings_of(parts)) {}

std::string Ballooning::found(const SimulationParts& parts) const {
  for (std::size_t i = 0; i < at_rest_.size(); ++i) {
    if (!under_held_pressure(*parts.actuators[i], at_rest_[i])) continue;
    const double now_m3 = *parts.reading_of(i).volume_m3, times = now_m3 / *at_rest_[i].initial_volume_m3;
    if (times < kGrown || now_m3 < kGrownNow * *at_rest_[i].volume_m3) continue;
    return text_of(at_rest_[i], at_rest_[i].gauge_pressure_pa.value_or(0.0), times);
  }
  return "";
}

int Ballooning::next_to_grow(const SimulationParts& parts) const {
  int chosen = -1;
  double most = 0.0;
  for (std::size_t i = 0; i < at_rest_.size(); ++i) {
    const ActuatorReading& chamber = at_rest_[i];
    const bool rises = under_held_pressure(*parts.actuators[i], chamber) &&
                       parts.state.drives[i].actuated_command > chamber.gauge_pressure_pa.value_or(0.0);
    if (!rises) continue;
    const double times = *chamber.volume_m3 / *chamber.initial_volume_m3;
    if (times > most) chosen = static_cast<int>(i);
    most = std::max(most, times);
  }
  return chosen;
}

std::string Ballooning::under_more_gas(SimulationParts& parts, SolveReport& report) const {
  const int chosen = next_to_grow(parts);
  if (chosen < 0) return "";
  const auto i = static_cast<std::size_t>(chosen);
  const SimulationState start = parts.state;
  const double asked_pa = start.drives[i].actuated_command;
  const double from_pa = at_rest_[i].gauge_pressure_pa.value_or(0.0);
  const StepStart now{std::numeric_limits<double>::infinity(), start.positions_m, start.velocities_m_s, {-from_pa}};
  double before_pa = from_pa, last_pa = from_pa, highest_pa = from_pa, share = 1.0, more = kMoreGas;
  std::string text;
  for (int times = 0; times < kMostGas && text.empty() && more > kLeastMoreGas; ++times) {
    if (!parts.actuators[i]->keep_supply(share * more, now, parts.state.drives[i])) break;
    if (relax(parts, report, {0.0, true}) != RestFound::stable) {
      more = std::sqrt(more);
      continue;
    }
    share *= more;
    const ActuatorReading chamber = parts.reading_of(i);
    const double pa = *chamber.gauge_pressure_pa, grown = *chamber.volume_m3 / *chamber.initial_volume_m3;
    if (pa >= kNearlyThere * asked_pa) break;
    if (last_pa > before_pa && last_pa >= pa) highest_pa = top_of(before_pa, last_pa, pa);
    before_pa = std::exchange(last_pa, pa);
    if (grown >= kGrown && pa < kFallen * highest_pa) text = text_of(at_rest_[i], highest_pa, grown);
  }
  parts.state = start;
  return text;
}

}  // namespace soft_robot_lab
