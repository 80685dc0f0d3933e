// SPDX-License-Identifier: BSD-3-Clause
#include "emulated_session.h"

#include <algorithm>

namespace soft_robot_lab {
namespace {

constexpr double update_period_s = 0.005;
constexpr double least_step_s = 1e-6;

}  // namespace

EmulatedSession::EmulatedSession(const RigSettings& rig_settings, std::uint64_t seed, const std::string& program)
    : settings(rig_settings), rig(static_cast<int>(settings.motors.size()), seed, program) {
  start_driver(true);
}

void EmulatedSession::start_driver(bool zero_at_start) {
  DriverOptions options;
  options.zero_at_start = zero_at_start;
  options.first_session = ++drivers_;
  driver_ = std::make_unique<MotorDriver>(settings, options, rig.ports());
}

void EmulatedSession::step(double limit_s) {
  if (driver_) driver_->update(rig.time_s());
  rig.run(std::clamp(limit_s, least_step_s, update_period_s));
  if (driver_) driver_->update(rig.time_s());
}

void EmulatedSession::run(double duration_s) {
  run_until([] { return false; }, duration_s);
}

bool EmulatedSession::run_until(const std::function<bool()>& reached, double limit_s) {
  const double end_s = rig.time_s() + limit_s;
  while (!reached()) {
    if (rig.time_s() >= end_s) return false;
    step(end_s - rig.time_s());
  }
  return true;
}

bool EmulatedSession::run_until_ready() {
  return run_until([this] {
    const auto motors = driver_->motors();
    return std::all_of(motors.begin(), motors.end(), [](const MotorStatus& motor) { return motor.known; });
  });
}

bool EmulatedSession::at_rest() const {
  const auto motors = driver_->motors();
  return driver_->commands().pending == 0 &&
         std::none_of(motors.begin(), motors.end(), [](const MotorStatus& motor) { return motor.moving; });
}

bool EmulatedSession::run_until_rest(double limit_s) {
  return run_until([this] { return at_rest(); }, limit_s);
}

void EmulatedSession::command(const std::vector<std::string>& names, const std::vector<double>& values) {
  driver_->command(names, values, rig.time_s());
  driver_->update(rig.time_s());
}

bool EmulatedSession::finish_operation() {
  return run_until([this] { return driver_->operation() != OperationState::running; }) &&
         driver_->operation() == OperationState::done;
}

}  // namespace soft_robot_lab
