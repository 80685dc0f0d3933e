// SPDX-License-Identifier: BSD-3-Clause
#include "solve_watch.h"

#include "settings/words.h"

namespace soft_robot_lab {
namespace {

constexpr double kFirst_s = 2.0, kLater = 1.4;  // times as long as the one before

// Where the walk to a rest state has come to.
std::string chambers_of(const Simulation& simulation) {
  std::string text;
  for (int i = 0; i < static_cast<int>(simulation.actuators().size()); ++i) {
    const ActuatorReading reading = simulation.actuator_state(i);
    if (!reading.gauge_pressure_pa || !reading.volume_m3 || !reading.initial_volume_m3) continue;
    const double more = *reading.volume_m3 / *reading.initial_volume_m3 - 1.0;
    text += "; " + printable(reading.name) + ": " + format_fixed(1e-3 * *reading.gauge_pressure_pa, 2) +
            " kPa, volume " + (more < 0.0 ? "" : "+") + format_fixed(100.0 * more, 0) + " %";
  }
  return text;
}

}  // namespace

void SolveWatch::begin(double now_s) {
  begin_s_ = now_s;
  next_s_ = kFirst_s;
}

std::optional<std::string> SolveWatch::say(double now_s) {
  const double runs_s = now_s - begin_s_;
  if (runs_s < next_s_) return std::nullopt;
  next_s_ = kLater * runs_s;
  return "solves for " + format_fixed(runs_s, 0) + " s" + chambers_of(simulation_) + "; Ctrl-C ends it";
}

}  // namespace soft_robot_lab
