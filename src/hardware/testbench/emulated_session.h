// SPDX-License-Identifier: BSD-3-Clause
// A driver of motors and an emulated rig in lock-step.
#pragma once

#include <memory>
#include <string>

#include "hardware/motor/motor_driver.h"
#include "lock_step_session.h"

namespace soft_robot_lab {

class EmulatedSession : public LockStepSession {
 public:
  // program: as in Testbench. The rig's robot hangs at rest when it gets power.
  explicit EmulatedSession(const RigSettings& settings, std::uint64_t seed = 1, const std::string& program = "");

  void start_driver(bool zero_at_start);  // a new one, as when the host's program starts again
  void stop_driver() { driver_.reset(); }

  bool run_until_ready();  // all positions known
  bool run_until_rest(double limit_s = 60.0);

  bool at_rest() const;
  double shaft(int motor) { return rig.shafts().at(static_cast<std::size_t>(motor)).shaft_steps; }
  MotorDriver& driver() { return *driver_; }

  const RigSettings settings;

 private:
  RigDriver* running_driver() override { return driver_.get(); }

  std::unique_ptr<MotorDriver> driver_;
  std::uint8_t drivers_ = 0;
};

}  // namespace soft_robot_lab
