// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

namespace soft_robot_lab {

// Steady, of this machine [s].
inline double machine_time_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace soft_robot_lab
