// SPDX-License-Identifier: BSD-3-Clause
#include "limit_hint.h"

namespace soft_robot_lab {
namespace {

std::string limit_key(const ActuatorReading& reading, const std::string& unit, bool least) {
  if (unit == "ml") return least ? "max_pull_ml, or min_offset_ml," : "syringe_volume_ml, or max_offset_ml,";
  if (unit == "Pa") return least ? "min_gauge_pressure_pa" : "max_gauge_pressure_pa";
  if (unit == "N") return least ? "" : "max_tension_n";
  if (unit != "1") return "";
  if (reading.volume_m3) return least ? "min_beta" : "max_beta";
  return least && reading.tension_n ? "min_contraction" : "";
}

}  // namespace

std::string limit_hint(const Simulation& simulation, int actuator, bool least) {
  const Actuator& one = *simulation.actuators()[static_cast<std::size_t>(actuator)];
  const std::string key = limit_key(simulation.actuator_state(actuator), one.limits().unit, least);
  return key.empty() ? "" : "; " + key + " of '" + one.name() + "' moves that limit";
}

}  // namespace soft_robot_lab
