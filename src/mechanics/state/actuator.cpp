// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/actuator.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "settings/read_name.h"

namespace soft_robot_lab {

void Actuator::initialise(const YamlNode& settings, const Body& body, const MeshLocator& locator) {
  name_ = read_name(settings);
  on_initialise(settings, body, locator);
}

DriveState Actuator::rest_state() const { return {limits_.rest, limits_.rest, 0.0, initial_memory()}; }

void Actuator::require_in_limits(double command) const {
  if (command >= limits_.min && command <= limits_.max) return;
  std::ostringstream message;
  message << "command of actuator '" << name_ << "': " << command << " is out of range [" << limits_.min << ", "
          << limits_.max << "]";
  throw std::invalid_argument(message.str());
}

void Actuator::set_command(double command, DriveState& drive) const {
  require_in_limits(command);
  if (drive.actuated_command == drive.command && command != drive.command) drive.wait_s = start_delay_s_;
  drive.command = command;
}

void Actuator::advance(double time_step_s, DriveState& drive) const {
  const double change = drive.command - drive.actuated_command;
  const double moving_s = std::max(0.0, time_step_s - drive.wait_s);
  drive.wait_s = std::max(0.0, drive.wait_s - time_step_s);
  const double reach = command_speed_ > 0.0 ? command_speed_ * moving_s : moving_s > 0.0 ? std::abs(change) : 0.0;
  place(std::abs(change) <= reach ? drive.command : drive.actuated_command + std::copysign(reach, change), drive);
}

void Actuator::place(double actuated_command, DriveState& drive) const {
  drive.actuated_command = std::clamp(actuated_command, limits_.min, limits_.max);
}

}  // namespace soft_robot_lab
