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
  command_ = limits_.rest;
  place(limits_.rest);
  initial_memory_ = memory();
}

void Actuator::set_command(double command) {
  if (!(command >= limits_.min && command <= limits_.max)) {
    std::ostringstream message;
    message << "command of actuator '" << name_ << "': " << command << " is out of range [" << limits_.min << ", "
            << limits_.max << "]";
    throw std::invalid_argument(message.str());
  }
  if (actuated_command_ == command_ && command != command_) wait_s_ = start_delay_s_;
  command_ = command;
}

void Actuator::advance(double time_step_s) {
  const double change = command_ - actuated_command_;
  const double moving_s = std::max(0.0, time_step_s - wait_s_);
  wait_s_ = std::max(0.0, wait_s_ - time_step_s);
  const double reach = command_speed_ > 0.0 ? command_speed_ * moving_s : moving_s > 0.0 ? std::abs(change) : 0.0;
  place(std::abs(change) <= reach ? command_ : actuated_command_ + std::copysign(reach, change));
}

void Actuator::place(double actuated_command) {
  actuated_command_ = std::clamp(actuated_command, limits_.min, limits_.max);
  actuate(actuated_command_);
}

void Actuator::reset() { restore(limits_.rest, limits_.rest, initial_memory_); }

void Actuator::restore(double command, double actuated_command, const Eigen::VectorXd& memory) {
  set_command(command);
  wait_s_ = memory[0];
  recall(memory.tail(memory.size() - 1));
  place(actuated_command);
}

Eigen::VectorXd Actuator::memory() const {
  const Eigen::VectorXd own = own_memory();
  Eigen::VectorXd all(1 + own.size());
  all[0] = wait_s_;
  all.tail(own.size()) = own;
  return all;
}

}  // namespace soft_robot_lab
