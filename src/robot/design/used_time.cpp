// SPDX-License-Identifier: BSD-3-Clause
#include "used_time.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>

#include <unistd.h>

namespace soft_robot_lab {
namespace {

struct Activity {
  bool can_run = false;      // runs, or waits for a core
  double processor_s = 0.0;  // with that of children that it has waited for
};

// proc(5): after the name in brackets come state, ten numbers, then utime, stime, cutime, cstime. A process that is
// gone does nothing.
Activity activity_of(const std::string& process) {
  std::ifstream file("/proc/" + process + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return {};
  std::istringstream rest(text.substr(name_end + 1));
  std::string state, skipped;
  rest >> state;
  for (int i = 0; i < 10; ++i) rest >> skipped;
  double ticks = 0.0, part = 0.0;
  for (int i = 0; i < 4 && rest >> part; ++i) ticks += part;
  return {state == "R", ticks / static_cast<double>(sysconf(_SC_CLK_TCK))};
}

Activity activity_with_descendants(const std::string& process) {
  Activity all = activity_of(process);
  std::ifstream children("/proc/" + process + "/task/" + process + "/children");
  for (std::string child; children >> child;) {
    const Activity one = activity_with_descendants(child);
    all.can_run = all.can_run || one.can_run;
    all.processor_s += one.processor_s;
  }
  return all;
}

}  // namespace

void UsedTime::look() {
  const auto now = std::chrono::steady_clock::now();
  const double passed_s = std::chrono::duration<double>(now - last_look_).count();
  const Activity activity = activity_with_descendants(std::to_string(process_));
  used_s_ += activity.can_run ? std::clamp(activity.processor_s - processor_s_, 0.0, passed_s) : passed_s;
  processor_s_ = activity.processor_s;
  last_look_ = now;
}

}  // namespace soft_robot_lab
