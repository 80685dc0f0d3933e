// SPDX-License-Identifier: BSD-3-Clause
// A driver and an emulated rig in lock-step: the driver is updated whenever a frame arrives, and every 5 ms.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hardware/motor/rig_driver.h"
#include "testbench.h"

namespace soft_robot_lab {

class LockStepSession {
 public:
  virtual ~LockStepSession() = default;

  void run(double duration_s);
  bool run_until(const std::function<bool()>& reached, double limit_s = 10.0);  // false when the time is up first
  void command(const std::vector<std::string>& names, const std::vector<double>& values);
  bool finish_operation();  // of the driver; false when it failed

  Testbench rig;

 protected:
  // What to start rig_emulator with, as Testbench has it.
  template <class Rig>
  LockStepSession(const Rig& rig_to_emulate, std::uint64_t seed, const std::string& program)
      : rig(rig_to_emulate, seed, program) {}

  virtual RigDriver* running_driver() = 0;  // or none

 private:
  void step(double limit_s);
};

}  // namespace soft_robot_lab
