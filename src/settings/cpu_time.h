// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>

namespace soft_robot_lab {

// What this process has computed so far, on all its threads.
inline double cpu_time_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1.0e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace soft_robot_lab
