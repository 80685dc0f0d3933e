// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <chrono>
#include <istream>

namespace soft_robot_lab {

struct Activity {
  bool can_run = false;      // runs, or waits for a core
  double processor_s = 0.0;  // with that of children that it has waited for
};

// From /proc/PROCESS/stat, proc(5): after the name in brackets come state, ten numbers, then utime, stime, cutime,
// cstime. A process that is gone does nothing.
Activity read_activity(std::istream& stat);

// How long a process and those it started ran or slept, without what they waited for a core, as on a machine with more
// work than cores. Each look adds the time since the last one: all of it where none could run at either, otherwise at
// most the processor time that they took. Time may pass between looks, as the one who looks waits for a core too.
class UsedTime {
 public:
  explicit UsedTime(pid_t process) : process_(process) {}

  void look();
  double seconds() const { return used_s_; }

 private:
  pid_t process_;
  std::chrono::steady_clock::time_point last_look_ = std::chrono::steady_clock::now();
  bool could_run_ = true;  // at the last look, as the next
  double processor_s_ = 0.0;
  double used_s_ = 0.0;
};

}  // namespace soft_robot_lab
