// SPDX-License-Identifier: BSD-3-Clause
// Judges from what the motors report whether the drives may move.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace soft_robot_lab {

struct MotorWatchReport {
  bool linked = false;
  bool emergency_stop = false;
  bool moving = false;              // any of them
  std::vector<std::string> names;   // of actuators
  std::vector<std::string> faults;  // one a name; empty where it may move
};

// Times are those of a clock that nobody sets [s].
class MotorWatch {
 public:
  void add(MotorWatchReport report, double now_s);

  // Why one of the actuators may not move, and what to do about it. Empty where all may, and where no motors ever
  // reported of themselves, as in a simulated session.
  std::string fault(const std::vector<std::string>& actuators, double now_s) const;
  bool known() const { return report_.has_value(); }  // motors ever reported
  bool moving() const { return report_ && report_->moving; }

 private:
  std::optional<MotorWatchReport> report_;
  double heard_s_ = 0.0;
};

}  // namespace soft_robot_lab
