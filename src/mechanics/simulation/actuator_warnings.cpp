// SPDX-License-Identifier: BSD-3-Clause
#include "actuator_warnings.h"

#include <cmath>
#include <sstream>

namespace soft_robot_lab {
namespace {

constexpr double kNoticed = 0.01;          // of the rest length: shorter of the command than this is as good as there
constexpr double kSensibleTension = 0.02;  // times E size^2: half the E A of a body a fifth as thick as long

SolveWarning about(const ActuatorReading& reading, const std::string& kind, double size, const std::string& unit) {
  SolveWarning warning;
  warning.kind = kind;
  warning.actuator = reading.name;
  warning.size = size;
  warning.unit = unit;
  return warning;
}

// A cable with a commanded length: too long where the body stands in its way, too short where nothing pulls it.
void check_length(const ActuatorReading& reading, std::vector<SolveWarning>& warnings) {
  const double commanded = *reading.commanded_length_m, reached = *reading.length_m, rest = *reading.rest_length_m;
  const double excess = reached - commanded;
  const bool pulls = commanded < rest, slack = reading.tension_n.value_or(1.0) <= 0.0;
  if (!pulls || std::abs(excess) <= kNoticed * rest || (excess < 0.0 && !slack)) return;
  SolveWarning warning = about(reading, excess > 0.0 ? "command_not_reached" : "slack", excess, "m");
  warning.commanded = commanded;
  warning.reached = reached;
  std::ostringstream text;
  text << "actuator " << reading.name << ": commanded to a length of " << commanded << " m, but it is " << reached
       << " m, ";
  if (excess > 0.0)
    text << excess << " m too long, at a tension of " << reading.tension_n.value_or(0.0) << " N";
  else
    text << "slack by " << -excess << " m";
  warning.text = text.str();
  warnings.push_back(std::move(warning));
}

void check_tension(const ActuatorReading& reading, const Body& body, std::vector<SolveWarning>& warnings) {
  const double most_n = kSensibleTension * body.material().youngs_modulus_pa * body.size_m() * body.size_m();
  if (std::abs(*reading.tension_n) <= most_n) return;
  SolveWarning warning = about(reading, "excessive_tension", *reading.tension_n, "N");
  std::ostringstream text;
  text << "actuator " << reading.name << ": a tension of " << *reading.tension_n
       << " N, beyond any sense for this body (more than " << most_n << " N, E size^2 / 50)";
  warning.text = text.str();
  warnings.push_back(std::move(warning));
}

// Walls that passed through one another enclose less than nothing.
void check_volume(const ActuatorReading& reading, std::vector<SolveWarning>& warnings) {
  if (*reading.volume_m3 > 0.0) return;
  SolveWarning warning = about(reading, "negative_volume", *reading.volume_m3, "m3");
  std::ostringstream text;
  text << "actuator " << reading.name << ": a volume of " << *reading.volume_m3
       << " m3, which must be above 0: its walls have passed through one another; contact: {self: true} keeps them "
          "apart";
  warning.text = text.str();
  warnings.push_back(std::move(warning));
}

}  // namespace

std::vector<SolveWarning> actuator_warnings(const ActuatorReading& reading, const Body& body) {
  std::vector<SolveWarning> warnings;
  if (reading.commanded_length_m && reading.length_m && reading.rest_length_m) check_length(reading, warnings);
  if (reading.tension_n) check_tension(reading, body, warnings);
  if (reading.volume_m3) check_volume(reading, warnings);
  return warnings;
}

bool refuse_impossible(const std::vector<SolveWarning>& warnings, SolveReport& report) {
  for (const SolveWarning& warning : warnings) {
    if (warning.kind != "negative_volume") continue;
    report.converged = false;
    report.message = warning.text;
    return true;
  }
  return false;
}

}  // namespace soft_robot_lab
