// SPDX-License-Identifier: BSD-3-Clause
#include "motor_driver.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "words.h"

namespace soft_robot_lab {

MotorDriver::MotorDriver(RigSettings rig, const DriverOptions& options, OpenPort open_port)
    : RigDriver(std::move(rig), options, std::move(open_port)), zero_at_start_due_(options.zero_at_start) {
  require_motors(this->rig(), "this driver");
}

void MotorDriver::zero(const std::vector<std::string>& names) { begin_operation(wire::kind_zero, mask_of(names)); }

void MotorDriver::on_ready() {
  if (!std::exchange(zero_at_start_due_, false)) return;
  std::uint8_t mask = 0;
  for (std::size_t i = 0; i < count(); ++i) {
    if ((drive(i).report->flags & wire::flag_power_up) != 0) mask = static_cast<std::uint8_t>(mask | 1U << i);
  }
  if (mask != 0) add_step({wire::kind_zero, {mask}});
}

void MotorDriver::on_report(const DriveReport& report) {
  const auto index = static_cast<std::size_t>(report.drive);
  const MotorSettings& settings = rig().motors[index];
  const double pulled = settings.direction * report.position / double(settings.drive.microsteps);
  spool_steps_[index] = std::clamp(spool_steps_[index], pulled, pulled + settings.backlash_steps);
}

void MotorDriver::on_done(const BoardRequest& request) {
  if (request.kind != wire::kind_zero) return;
  for (std::size_t i = 0; i < count(); ++i)
    if ((request.payload[0] & 1U << i) != 0) spool_steps_[i] = 0.0;
}

std::int32_t MotorDriver::on_wire(int motor, double steps) const {
  return static_cast<std::int32_t>(std::lround(steps * rig().motors[static_cast<std::size_t>(motor)].drive.microsteps));
}

// Pulling, the spool is at the shaft; releasing, the shaft turns through the backlash first.
double MotorDriver::target_of(int index, double value) const {
  const MotorSettings& motor = rig().motors[static_cast<std::size_t>(index)];
  const double steps = steps_of(motor, value);
  if (motor.backlash_steps == 0.0) return steps;
  const bool releases = motor.direction * steps < spool_steps_[static_cast<std::size_t>(index)];
  return releases ? steps - motor.direction * motor.backlash_steps : steps;
}

std::string MotorDriver::words_of_flags(std::uint16_t flags) const { return soft_robot_lab::words_of_flags(flags); }

std::vector<MotorStatus> MotorDriver::motors() const {
  std::vector<MotorStatus> all;
  for (std::size_t i = 0; i < count(); ++i) {
    const DriveReport& last = drive(i).last;
    const std::optional<double> asked = asked_target(i);
    const double unit = rig().motors[i].drive.microsteps;
    MotorStatus status;
    status.position_steps = last.position / unit;
    status.target_steps = asked.value_or(last.target / unit);
    status.spool_steps = spool_steps_[i];
    status.flags = last.flags;
    status.known = ready() && (last.flags & wire::flag_known) != 0;
    status.moving = (last.flags & wire::flag_moving) != 0 || asked;
    status.fault = fault_of(static_cast<int>(i));
    all.push_back(status);
  }
  return all;
}

}  // namespace soft_robot_lab
