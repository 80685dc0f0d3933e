// SPDX-License-Identifier: BSD-3-Clause
#include "lamps.h"

#include <algorithm>
#include <cmath>

#include "settings/words.h"

namespace soft_robot_lab {
namespace {

constexpr char simulation[] = "simulator: simulation";
constexpr char motors[] = "motor: motors";
constexpr char session_watch[] = "session_watch: session";

Lamp::Level level_of(const diagnostic_msgs::DiagnosticStatus& status) {
  if (status.level == diagnostic_msgs::DiagnosticStatus::OK) return Lamp::Level::ok;
  return status.level == diagnostic_msgs::DiagnosticStatus::WARN ? Lamp::Level::warn : Lamp::Level::error;
}

// Empty for another session's.
std::string without_session(const std::string& name, const std::string& session) {
  const std::size_t begin = name.find_first_not_of('/');
  const std::string bare = begin == std::string::npos ? "" : name.substr(begin);
  if (session.empty()) return bare;
  return bare.rfind(session + "/", 0) == 0 ? bare.substr(session.size() + 1) : "";
}

// Of "training: 40 %, ..."; nothing of another text.
std::optional<double> trained_share(const std::string& status) {
  constexpr char begins[] = "training: ";
  const std::size_t end = status.find(" %");
  if (status.rfind(begins, 0) != 0 || end == std::string::npos) return std::nullopt;
  const auto percent = parse_number<double>(status.substr(sizeof begins - 1, end - (sizeof begins - 1)));
  if (!percent || !(*percent >= 0.0 && *percent <= 100.0)) return std::nullopt;
  return 0.01 * *percent;
}

// Whoever sees no colours reads it.
std::string word_of(Lamp::Level level) {
  switch (level) {
    case Lamp::Level::ok:
      return "";
    case Lamp::Level::warn:
      return "look";
    case Lamp::Level::error:
      return "fault";
    case Lamp::Level::unknown:
      break;
  }
  return "?";
}

}  // namespace

void Lamps::add(const diagnostic_msgs::DiagnosticArray& diagnostics, double now_s) {
  for (const auto& status : diagnostics.status) {
    const std::string name = without_session(status.name, session_);
    if (name == simulation || name == motors || name == session_watch) heard_[name] = {status, now_s};
  }
}

void Lamps::add(const RealityGap& gap, double now_s) {
  if (!std::isfinite(gap.rms_m)) return;
  gap_rms_m_ = gap.rms_m;
  gap_at_s_ = now_s;
}

Lamp Lamps::lamp_of(const std::string& name, const std::string& task, double now_s) const {
  Lamp lamp;
  lamp.name = name;
  const auto heard = heard_.find(task);
  if (heard == heard_.end() || now_s - heard->second.at_s > silence_s) {
    lamp.reason = "nothing heard of it";
  } else {
    lamp.level = level_of(heard->second.status);
    lamp.reason = heard->second.status.message;
  }
  lamp.value = word_of(lamp.level);
  return lamp;
}

// Of the simulation's diagnosis; nothing where that has no such value.
std::optional<std::string> Lamps::text_of_key(const std::string& key, double now_s) const {
  if (lamp_of("", simulation, now_s).level == Lamp::Level::unknown) return std::nullopt;
  for (const auto& value : heard_.at(simulation).status.values)
    if (value.key == key) return value.value;
  return std::nullopt;
}

// A step or a load of the simulation.
bool Lamps::lasts(double now_s) const { return text_of_key("lasts [s]", now_s).has_value(); }

std::optional<double> Lamps::value_of(const std::string& key, double now_s) const {
  const std::optional<std::string> text = text_of_key(key, now_s);
  return text ? parse_number<double>(*text) : std::nullopt;
}

Lamp Lamps::squeezed(double least) {
  const Lamp::Level level = least <= 0.0 ? Lamp::Level::error : least < 0.2 ? Lamp::Level::warn : Lamp::Level::ok;
  return {"det F", level, format_fixed(least, 2),
          "least volume of the silicone over that at rest, element by element: below 0 the mesh is turned over"};
}

// Of a reduced model; who moves the robot meanwhile stands beside it.
Lamp Lamps::audited(double error_m, double now_s) const {
  const double trusted_m = value_of("trusted error [m]", now_s).value_or(0.0);
  const bool moves = text_of_key("solver", now_s) == "reduced";
  const std::string value = moves ? format_fixed(1e3 * error_m, 2) + " mm" : "newton";
  return {"Reduced", moves ? Lamp::Level::ok : Lamp::Level::warn, value,
          "largest error of the reduced model that an audit estimated; it is left for newton beyond " +
              format_fixed(1e3 * trusted_m, 2) + " mm"};
}

Lamp Lamps::training(const std::string& status) {
  return {"Reduced", trained_share(status) ? Lamp::Level::ok : Lamp::Level::warn, "newton", status};
}

std::optional<Lamps::Training> Lamps::training(double now_s) const {
  const std::optional<std::string> status = text_of_key("reduced model", now_s);
  const std::optional<double> share = status ? trained_share(*status) : std::nullopt;
  return share ? std::optional(Training{*share, *status}) : std::nullopt;
}

Lamp Lamps::contact(double force_n) {
  return {"Contact", Lamp::Level::ok, force_n > 0.0 ? format_fixed(force_n, 2) + " N" : "none",
          "sum of the forces with which the skin is pressed"};
}

// In the window, not in a hint alone, where something lasts that Stop ends.
Lamp Lamps::simulated(double now_s) const {
  Lamp lamp = lamp_of("Simulation", simulation, now_s);
  if (lasts(now_s)) lamp.value = lamp.reason;
  return lamp;
}

Lamp Lamps::speed(double now_s) const {
  Lamp lamp = lamp_of("Speed", simulation, now_s);
  if (lamp.level == Lamp::Level::unknown) return lamp;
  if (lasts(now_s)) return {"Speed", Lamp::Level::warn, "0.00 x", lamp.reason};
  for (const auto& value : heard_.at(simulation).status.values) {
    if (value.key != "real-time factor") continue;
    const double factor = parse_number<double>(value.value).value_or(0.0);
    lamp.level = factor < 0.9 ? Lamp::Level::warn : Lamp::Level::ok;
    lamp.value = format_fixed(factor, 2) + " x";
    lamp.reason = "simulated seconds in a second";
  }
  return lamp;
}

Lamp Lamps::gap(double now_s) const {
  Lamp lamp;
  lamp.name = "Gap";
  if (now_s - gap_at_s_ > silence_s) {
    lamp.value = "?";
    lamp.reason = "no measured markers";
    return lamp;
  }
  lamp.level = Lamp::Level::ok;
  lamp.value = format_fixed(1e3 * gap_rms_m_, 2) + " mm";
  lamp.reason = "measured less simulated markers, root mean square";
  return lamp;
}

std::string Lamps::link_fault(double now_s) const {
  if (heard_.count(motors) == 0) return "";
  const Lamp link = lamp_of("Link", motors, now_s);
  return link.level == Lamp::Level::error ? link.reason : "";
}

std::vector<Lamp> Lamps::lamps(double now_s) const {
  std::vector<Lamp> lamps = {simulated(now_s), speed(now_s)};
  if (heard_.count(motors) > 0) lamps.push_back(lamp_of("Link", motors, now_s));
  if (gap_at_s_ >= 0.0) lamps.push_back(gap(now_s));
  if (const auto status = text_of_key("reduced model", now_s)) lamps.push_back(training(*status));
  if (const auto error_m = value_of("audited error [m]", now_s)) lamps.push_back(audited(*error_m, now_s));
  if (const auto least = value_of("least det F", now_s)) lamps.push_back(squeezed(*least));
  if (const auto force_n = value_of("contact force [N]", now_s)) lamps.push_back(contact(*force_n));
  if (heard_.count(session_watch) > 0) lamps.push_back(lamp_of("Session", session_watch, now_s));
  return lamps;
}

}  // namespace soft_robot_lab
