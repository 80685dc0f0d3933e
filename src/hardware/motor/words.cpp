// SPDX-License-Identifier: BSD-3-Clause
#include "words.h"

#include <utility>
#include <vector>

namespace soft_robot_lab {

std::string words(wire::Result result) {
  switch (result) {
    case wire::result_done:
      return "done";
    case wire::result_not_configured:
      return "not configured";
    case wire::result_beyond_limit:
      return "beyond the board's limits";
    case wire::result_position_unknown:
      return "position unknown: zero it first, or not measured yet";
    case wire::result_fault:
      return "a fault is latched: clear it first";
    case wire::result_emergency_stop:
      return "emergency stop: clear it first";
    case wire::result_moving:
      return "the motor moves";
    case wire::result_no_motor:
      return "the board has no such drive";
    case wire::result_wrong_session:
      return "another session";
    case wire::result_out_of_order:
      return "out of order";
    case wire::result_bad_value:
      return "a value the board does not take";
    case wire::result_count:
      break;
  }
  return "unknown result " + std::to_string(static_cast<int>(result));
}

namespace {

using FlagName = std::pair<std::uint16_t, const char*>;

std::string names_of(std::uint16_t flags, const std::vector<FlagName>& table) {
  std::string text;
  for (const auto& [flag, name] : table) {
    if ((flags & flag) != 0) text += (text.empty() ? "" : ", ") + std::string(name);
  }
  return text.empty() ? "" : text + ": clear it first";
}

}  // namespace

std::string words_of_firmware(std::uint8_t firmware) {
  if (firmware == wire::firmware_motors) return "stepper motors";
  if (firmware == wire::firmware_pressures) return "pressure channels";
  return "something unknown, kind " + std::to_string(static_cast<int>(firmware));
}

std::string words_of_flags(std::uint16_t flags) {
  const std::string names = names_of(flags, {{wire::flag_emergency_stop, "emergency stop"},
                                             {wire::flag_overcurrent, "over-current"},
                                             {wire::flag_stall, "stall"},
                                             {wire::flag_overheated, "too hot"},
                                             {wire::flag_undervoltage, "undervoltage"},
                                             {wire::flag_no_answer, "no answer from its driver chip"}});
  if (!names.empty()) return names;
  return (flags & wire::flag_known) != 0 ? "" : "position unknown: zero it first";
}

std::string words_of_pressure_flags(std::uint16_t flags) {
  const std::string names = names_of(flags, {{wire::flag_emergency_stop, "emergency stop"},
                                             {wire::flag_sensor, "silent sensor: its voltage is out of range"},
                                             {wire::flag_burst, "burst tube: the pressure does not rise"},
                                             {wire::flag_stuck, "stuck valve: the pressure does not follow"},
                                             {wire::flag_over_pressure, "pressure beyond its limit"}});
  if (!names.empty()) return names;
  return (flags & wire::flag_known) != 0 ? "" : "not measured yet";
}

}  // namespace soft_robot_lab
