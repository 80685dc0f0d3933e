// SPDX-License-Identifier: BSD-3-Clause
#include "emulated_session.h"

#include <algorithm>

namespace soft_robot_lab {
namespace {

int motor_count(const RigSettings& rig) {
  require_motors(rig, "this emulated session");
  return static_cast<int>(rig.motors.size());
}

}  // namespace

EmulatedSession::EmulatedSession(const RigSettings& rig_settings, std::uint64_t seed, const std::string& program)
    : LockStepSession(motor_count(rig_settings), seed, program), settings(rig_settings) {
  start_driver(true);
}

void EmulatedSession::start_driver(bool zero_at_start) {
  DriverOptions options;
  options.zero_at_start = zero_at_start;
  options.first_session = ++drivers_;
  driver_ = std::make_unique<MotorDriver>(settings, options, rig.ports());
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

}  // namespace soft_robot_lab
