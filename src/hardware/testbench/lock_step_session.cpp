// SPDX-License-Identifier: BSD-3-Clause
#include "lock_step_session.h"

#include <algorithm>

namespace soft_robot_lab {
namespace {

constexpr double update_period_s = 0.005;
constexpr double least_step_s = 1e-6;

}  // namespace

void LockStepSession::step(double limit_s) {
  RigDriver* driver = running_driver();
  if (driver) driver->update(rig.time_s());
  rig.run(std::clamp(limit_s, least_step_s, update_period_s));
  if (driver) driver->update(rig.time_s());
}

void LockStepSession::run(double duration_s) {
  run_until([] { return false; }, duration_s);
}

bool LockStepSession::run_until(const std::function<bool()>& reached, double limit_s) {
  const double end_s = rig.time_s() + limit_s;
  while (!reached()) {
    if (rig.time_s() >= end_s) return false;
    step(end_s - rig.time_s());
  }
  return true;
}

void LockStepSession::command(const std::vector<std::string>& names, const std::vector<double>& values) {
  running_driver()->command(names, values, rig.time_s());
  running_driver()->update(rig.time_s());
}

bool LockStepSession::finish_operation() {
  return run_until([this] { return running_driver()->operation() != OperationState::running; }) &&
         running_driver()->operation() == OperationState::done;
}

}  // namespace soft_robot_lab
