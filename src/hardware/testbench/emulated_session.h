// SPDX-License-Identifier: BSD-3-Clause
// A driver and an emulated rig in lock-step: the driver is updated whenever a frame arrives, and every 5 ms.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hardware/motor/motor_driver.h"
#include "testbench.h"

namespace soft_robot_lab {

class EmulatedSession {
 public:
  // program: as in Testbench. The rig's robot hangs at rest when it gets power.
  explicit EmulatedSession(const RigSettings& settings, std::uint64_t seed = 1, const std::string& program = "");

  void start_driver(bool zero_at_start);  // a new one, as when the host's program starts again
  void stop_driver() { driver_.reset(); }

  void run(double duration_s);
  bool run_until(const std::function<bool()>& reached, double limit_s = 10.0);  // false when the time is up first
  bool run_until_ready();                                                       // all positions known
  bool run_until_rest(double limit_s = 60.0);
  void command(const std::vector<std::string>& names, const std::vector<double>& values);
  bool finish_operation();  // of the driver; false when it failed

  bool at_rest() const;
  double shaft(int motor) { return rig.shafts().at(static_cast<std::size_t>(motor)).shaft_steps; }
  MotorDriver& driver() { return *driver_; }

  const RigSettings settings;
  Testbench rig;

 private:
  void step(double limit_s);

  std::unique_ptr<MotorDriver> driver_;
  std::uint8_t drivers_ = 0;
};

}  // namespace soft_robot_lab
