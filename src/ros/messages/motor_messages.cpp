// SPDX-License-Identifier: BSD-3-Clause
#include "motor_messages.h"

#include <stdexcept>
#include <string>

namespace soft_robot_lab {

MotorState motor_state(const MotorDriver& driver, const ros::Time& stamp) {
  MotorState message;
  message.header.stamp = stamp;
  message.linked = driver.ready();
  message.emergency_stop = driver.emergency_stopped();
  const auto motors = driver.motors();
  for (std::size_t i = 0; i < motors.size(); ++i) {
    const MotorSettings& settings = driver.rig().motors[i];
    const MotorStatus& motor = motors[i];
    message.names.push_back(settings.name);
    message.position_steps.push_back(motor.position_steps);
    message.target_steps.push_back(motor.target_steps);
    message.pull_m.push_back(motor.spool_steps * settings.step_m);
    message.values.push_back(value_of(settings, settings.direction * motor.spool_steps));
    message.known.push_back(motor.known);
    message.moving.push_back(motor.moving);
    message.fault.push_back(motor.fault);
  }
  return message;
}

ShaftState shaft_state(const RigSettings& rig, const std::vector<ShaftTruth>& shafts, const ros::Time& stamp) {
  if (shafts.size() != rig.motors.size()) {
    throw std::runtime_error("the emulated rig has " + std::to_string(shafts.size()) + " motors, the rig's file " +
                             std::to_string(rig.motors.size()));
  }
  ShaftState message;
  message.header.stamp = stamp;
  for (std::size_t i = 0; i < shafts.size(); ++i) {
    message.names.push_back(rig.motors[i].name);
    message.position_steps.push_back(shafts[i].shaft_steps);
    message.values.push_back(value_of(rig.motors[i], shafts[i].spool_steps));
    message.moving.push_back(shafts[i].moving);
  }
  return message;
}

void diagnose_motors(const MotorDriver& driver, diagnostic_updater::DiagnosticStatusWrapper& status) {
  using Status = diagnostic_msgs::DiagnosticStatus;
  const auto motors = driver.motors();
  status.summary(Status::OK, "linked");
  if (driver.emergency_stopped())
    status.mergeSummary(Status::WARN, "stopped; Clear (motor/clear) lets the motors move");
  if (!driver.ready()) {
    status.mergeSummary(Status::ERROR, "no link: " + driver.link_failure());
  } else {
    for (std::size_t i = 0; i < motors.size(); ++i) {
      const std::string name = driver.rig().motors[i].name + ": ";
      const bool fault = (motors[i].flags & wire::fault_flags) != 0;
      if (fault) status.mergeSummary(Status::ERROR, name + motors[i].fault);
      if (!fault && !motors[i].known) status.mergeSummary(Status::WARN, name + motors[i].fault);
      if ((motors[i].flags & wire::flag_thermal_warning) != 0) status.mergeSummary(Status::WARN, name + "gets hot");
      if ((motors[i].flags & wire::flag_host_silent) != 0) {
        status.mergeSummary(Status::WARN, name + "stopped by the board, as this driver was silent");
      }
    }
  }
  const CommandCounts commands = driver.commands();
  status.add("received commands", commands.received);
  status.add("acknowledged commands", commands.acknowledged);
  status.add("superseded commands", commands.superseded);
  status.add("refused commands", commands.refused);
  status.add("pending commands", commands.pending);
  status.add("last refusal", driver.last_refusal());
  const LinkCounts& link = driver.link_counts();
  status.add("frames sent", link.sent);
  status.add("frames sent again", link.resent);
  status.add("frames received", link.received);
  status.add("frames damaged", link.damaged);
  status.add("links opened", link.opened);
  status.add("links lost", link.lost);
}

}  // namespace soft_robot_lab
