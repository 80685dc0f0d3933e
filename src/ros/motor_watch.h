// SPDX-License-Identifier: BSD-3-Clause
// Judges from motor/state whether the drives may move.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <ros/time.h>
#include <soft_robot_lab/MotorState.h>

namespace soft_robot_lab {

class MotorWatch {
 public:
  void add(const MotorState& state, const ros::SteadyTime& now);

  // Why one of the actuators may not move, and what to do about it. Empty where all may, and where no motors ever
  // reported of themselves, as in a simulated session.
  std::string fault(const std::vector<std::string>& actuators, const ros::SteadyTime& now) const;
  bool known() const { return state_.has_value(); }  // motors ever reported
  bool moving() const;

 private:
  std::optional<MotorState> state_;
  ros::SteadyTime heard_;
};

}  // namespace soft_robot_lab
