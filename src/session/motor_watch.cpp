// SPDX-License-Identifier: BSD-3-Clause
#include "motor_watch.h"

#include <algorithm>

namespace soft_robot_lab {

void MotorWatch::add(MotorWatchReport report, double now_s) {
  report_ = std::move(report);
  heard_s_ = now_s;
}

std::string MotorWatch::fault(const std::vector<std::string>& actuators, double now_s) const {
  // Fifty reports; must stay below the 3 s that motor.launch waits before it starts the node anew.
  constexpr double silence_s = 1.0;
  if (!report_) return "";
  if (now_s - heard_s_ > silence_s) return "the motors' node is silent";
  if (!report_->linked) return "no link to the motors' board";
  if (report_->emergency_stop) return "emergency stop; clear it with motor/clear";
  for (size_t i = 0; i < report_->names.size() && i < report_->faults.size(); ++i) {
    const bool needed = std::find(actuators.begin(), actuators.end(), report_->names[i]) != actuators.end();
    if (needed && !report_->faults[i].empty()) return "motor " + report_->names[i] + ": " + report_->faults[i];
  }
  return "";
}

}  // namespace soft_robot_lab
