// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstring>
#include <thread>

namespace soft_robot_lab {

// roslaunch stops halfway, and leaves its master behind, where a required process ends while it still starts others. So
// one that it started and that fails ends some seconds after it began: `begin`.
inline void outlast_launch(int argc, char** argv, std::chrono::steady_clock::time_point begin) {
  constexpr std::chrono::seconds launching(5);
  for (int i = 1; i < argc; ++i)
    if (std::strncmp(argv[i], "__log:=", 7) == 0) return std::this_thread::sleep_until(begin + launching);
}

}  // namespace soft_robot_lab
