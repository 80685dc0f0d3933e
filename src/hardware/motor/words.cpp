// SPDX-License-Identifier: BSD-3-Clause
#include "words.h"

namespace soft_robot_lab {

std::string words(wire::Result result) {
  switch (result) {
    case wire::result_done:
      return "done";
    case wire::result_not_configured:
      return "the motor is not configured";
    case wire::result_beyond_limit:
      return "beyond the board's limits";
    case wire::result_position_unknown:
      return "position unknown: zero it first";
    case wire::result_fault:
      return "a fault is latched: clear it first";
    case wire::result_emergency_stop:
      return "emergency stop: clear it first";
    case wire::result_moving:
      return "the motor moves";
    case wire::result_no_motor:
      return "no such motor driver on the board";
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

std::string words_of_flags(std::uint16_t flags) {
  const std::pair<std::uint16_t, const char*> table[] = {{wire::flag_emergency_stop, "emergency stop"},
                                                         {wire::flag_overcurrent, "over-current"},
                                                         {wire::flag_stall, "stall"},
                                                         {wire::flag_overheated, "too hot"},
                                                         {wire::flag_undervoltage, "undervoltage"},
                                                         {wire::flag_no_answer, "no answer from its driver chip"}};
  std::string text;
  for (const auto& [flag, name] : table) {
    if ((flags & flag) != 0) text += (text.empty() ? "" : ", ") + std::string(name);
  }
  if (!text.empty()) return text + ": clear it first";
  return (flags & wire::flag_known) != 0 ? "" : "position unknown: zero it first";
}

}  // namespace soft_robot_lab
