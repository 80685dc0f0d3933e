#include "soft_robot_lab/sim/actuator.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "soft_robot_lab/settings/settings_node.h"

namespace soft_robot_lab {

void Actuator::initialise(const SettingsNode& settings, const Body& body, const MeshLocator& locator) {
  name_ = settings.text("name");
  if (name_.empty()) settings.fail("name must not be empty");
  on_initialise(settings, body, locator);
  restore(limits_.rest, limits_.rest);
}

void Actuator::set_command(double command) {
  if (!(command >= limits_.min && command <= limits_.max)) {
    std::ostringstream message;
    message << "command of actuator '" << name_ << "': " << command << " is out of range [" << limits_.min << ", "
            << limits_.max << "]";
    throw std::invalid_argument(message.str());
  }
  command_ = command;
}

void Actuator::advance(double time_step_s) {
  const double change = command_ - actuated_command_;
  const double reach = command_speed_ > 0.0 ? command_speed_ * time_step_s : std::abs(change);
  actuated_command_ = std::abs(change) <= reach ? command_ : actuated_command_ + std::copysign(reach, change);
  actuate(actuated_command_);
}

void Actuator::restore(double command, double actuated_command) {
  set_command(command);
  actuated_command_ = std::clamp(actuated_command, limits_.min, limits_.max);
  actuate(actuated_command_);
}

}  // namespace soft_robot_lab
