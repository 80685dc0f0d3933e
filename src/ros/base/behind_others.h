// SPDX-License-Identifier: BSD-3-Clause
// Work that may take long leaves the cores to those that a user waits for: simulation, and window.
#pragma once

#include <future>

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace soft_robot_lab {

// Waits for `work`, done on a thread of less priority. What it throws comes through.
template <typename Work>
auto behind_others(const Work& work) {
  return std::async(std::launch::async,
                    [&work] {
                      constexpr int behind = 10;  // as `nice` has it
                      setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), behind);
                      return work();
                    })
      .get();
}

}  // namespace soft_robot_lab
