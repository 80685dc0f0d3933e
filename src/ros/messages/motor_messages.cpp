// SPDX-License-Identifier: BSD-3-Clause
#include "motor_messages.h"

#include <algorithm>
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

MotorState motor_state(const PressureDriver& driver, const ros::Time& stamp) {
  const PressureState pressures = pressure_state(driver, stamp);
  MotorState message;
  message.header = pressures.header;
  message.linked = pressures.linked;
  message.emergency_stop = pressures.emergency_stop;
  message.names = pressures.names;
  message.position_steps = message.target_steps = message.pull_m = std::vector<double>(pressures.names.size(), 0.0);
  message.values = pressures.pressure_pa;
  message.known = pressures.known;
  message.moving = pressures.settling;
  message.fault = pressures.fault;
  return message;
}

PressureState pressure_state(const PressureDriver& driver, const ros::Time& stamp) {
  PressureState message;
  message.header.stamp = stamp;
  message.linked = driver.ready();
  message.emergency_stop = driver.emergency_stopped();
  const auto channels = driver.channels();
  for (std::size_t i = 0; i < channels.size(); ++i) {
    message.names.push_back(driver.rig().channels[i].name);
    message.pressure_pa.push_back(channels[i].pressure_pa);
    message.set_point_pa.push_back(channels[i].set_point_pa);
    message.known.push_back(channels[i].known);
    message.settling.push_back(channels[i].settling);
    message.fault.push_back(channels[i].fault);
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

ShaftState shaft_state(const RigSettings& rig, const std::vector<double>& pressures_pa, const ros::Time& stamp) {
  if (pressures_pa.size() != rig.channels.size()) {
    throw std::runtime_error("the emulated rig has " + std::to_string(pressures_pa.size()) +
                             " pressure channels, the rig's file " + std::to_string(rig.channels.size()));
  }
  ShaftState message;
  message.header.stamp = stamp;
  for (std::size_t i = 0; i < pressures_pa.size(); ++i) {
    message.names.push_back(rig.channels[i].name);
    message.position_steps.push_back(0.0);
    message.values.push_back(std::max(0.0, pressures_pa[i]));
    message.moving.push_back(false);
  }
  return message;
}

namespace {

using Status = diagnostic_msgs::DiagnosticStatus;

void diagnose_drive(const std::string& name, std::uint16_t flags, bool known, const std::string& fault,
                    diagnostic_updater::DiagnosticStatusWrapper& status) {
  const bool faulty = (flags & wire::fault_flags) != 0;
  if (faulty) status.mergeSummary(Status::ERROR, name + ": " + fault);
  if (!faulty && !known) status.mergeSummary(Status::WARN, name + ": " + fault);
  if ((flags & wire::flag_host_silent) != 0)
    status.mergeSummary(Status::WARN, name + ": stopped by the board, as this driver was silent");
}

// Whether its drives are to be looked at.
bool diagnose_link(const RigDriver& driver, diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(Status::OK, "linked");
  if (driver.emergency_stopped())
    status.mergeSummary(Status::WARN, "stopped; Clear (motor/clear) lets the motors move");
  if (driver.ready()) return true;
  status.mergeSummary(Status::ERROR, "no link: " + driver.link_failure());
  return false;
}

void add_counts(const RigDriver& driver, diagnostic_updater::DiagnosticStatusWrapper& status) {
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

}  // namespace

void diagnose(const MotorDriver& driver, diagnostic_updater::DiagnosticStatusWrapper& status) {
  const auto motors = driver.motors();
  if (diagnose_link(driver, status)) {
    for (std::size_t i = 0; i < motors.size(); ++i) {
      const std::string& name = driver.rig().motors[i].name;
      diagnose_drive(name, motors[i].flags, motors[i].known, motors[i].fault, status);
      if ((motors[i].flags & wire::flag_thermal_warning) != 0) status.mergeSummary(Status::WARN, name + ": gets hot");
    }
  }
  add_counts(driver, status);
}

void diagnose(const PressureDriver& driver, diagnostic_updater::DiagnosticStatusWrapper& status) {
  const auto channels = driver.channels();
  if (diagnose_link(driver, status)) {
    for (std::size_t i = 0; i < channels.size(); ++i)
      diagnose_drive(driver.rig().channels[i].name, channels[i].flags, channels[i].known, channels[i].fault, status);
  }
  for (std::size_t i = 0; i < channels.size(); ++i)
    status.add(driver.rig().channels[i].name + " [kPa]", 1e-3 * channels[i].pressure_pa);
  add_counts(driver, status);
}

}  // namespace soft_robot_lab
