// SPDX-License-Identifier: BSD-3-Clause
#include "used_time.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include <unistd.h>

namespace soft_robot_lab {
namespace {

Activity activity_of(const std::string& process) {
  std::ifstream file("/proc/" + process + "/stat");
  return read_activity(file);
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

Activity read_activity(std::istream& stat) {
  std::ostringstream all;
  all << stat.rdbuf();  // fails without an exception where the process ended after the file was opened
  const std::string text = all.str();
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

void UsedTime::look() {
  const auto now = std::chrono::steady_clock::now();
  const double passed_s = std::chrono::duration<double>(now - last_look_).count();
  const Activity activity = activity_with_descendants(std::to_string(process_));
  const bool slept = !could_run_ && !activity.can_run;
  used_s_ += slept ? passed_s : std::clamp(activity.processor_s - processor_s_, 0.0, passed_s);
  could_run_ = activity.can_run;
  processor_s_ = activity.processor_s;
  last_look_ = now;
}

}  // namespace soft_robot_lab
