// SPDX-License-Identifier: BSD-3-Clause
#include "motor_watch.h"

#include <algorithm>

namespace soft_robot_lab {

void MotorWatch::add(const MotorState& state, const ros::SteadyTime& now) {
  state_ = state;
  heard_ = now;
}

std::string MotorWatch::fault(const std::vector<std::string>& actuators, const ros::SteadyTime& now) const {
  // Fifty states; must stay below the 3 s that motor.launch waits before it starts the node anew.
  constexpr double silence_s = 1.0;
  if (!state_) return "";
  if ((now - heard_).toSec() > silence_s) return "the motors' node is silent";
  if (!state_->linked) return "no link to the motors' board";
  if (state_->emergency_stop) return "emergency stop; clear it with motor/clear";
  for (size_t i = 0; i < state_->names.size() && i < state_->fault.size(); ++i) {
    const bool needed = std::find(actuators.begin(), actuators.end(), state_->names[i]) != actuators.end();
    if (needed && !state_->fault[i].empty()) return "motor " + state_->names[i] + ": " + state_->fault[i];
  }
  return "";
}

bool MotorWatch::moving() const {
  return state_ && std::any_of(state_->moving.begin(), state_->moving.end(), [](auto moves) { return moves != 0; });
}

}  // namespace soft_robot_lab
