// SPDX-License-Identifier: BSD-3-Clause
// A driver of pressure channels and an emulated rig in lock-step.
#pragma once

#include <memory>
#include <string>

#include "hardware/motor/pressure_driver.h"
#include "lock_step_session.h"

namespace soft_robot_lab {

class PressureSession : public LockStepSession {
 public:
  // program: as in Testbench. Throws SettingsError, and std::invalid_argument for a rig of motors.
  explicit PressureSession(const std::string& rig_file, std::uint64_t seed = 1, const std::string& program = "");

  void start_driver();  // a new one, as when the host's program starts again
  void stop_driver() { driver_.reset(); }

  bool run_until_ready();  // all pressures measured
  PressureDriver& driver() { return *driver_; }
  PressureStatus channel(std::size_t index) { return driver_->channels().at(index); }

  const RigSettings settings;

 private:
  RigDriver* running_driver() override { return driver_.get(); }

  std::unique_ptr<PressureDriver> driver_;
  std::uint8_t drivers_ = 0;
};

}  // namespace soft_robot_lab
