// SPDX-License-Identifier: BSD-3-Clause
// What tests of emulated rigs ask of refusals.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "hardware/testbench/lock_step_session.h"

namespace soft_robot_lab {

// Of a command; empty where it is taken.
inline std::string refusal(LockStepSession& session, const std::vector<std::string>& names,
                           const std::vector<double>& values) {
  try {
    session.command(names, values);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace soft_robot_lab
