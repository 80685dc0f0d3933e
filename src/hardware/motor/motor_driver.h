// SPDX-License-Identifier: BSD-3-Clause
// Drives a rig of stepper motors: contractions of cables or travels of plungers to positions of shafts.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "rig_driver.h"

namespace soft_robot_lab {

// Positions are the shaft's, in full steps.
struct MotorStatus {
  double position_steps = 0.0;
  double target_steps = 0.0;
  double spool_steps = 0.0;  // behind the backlash
  bool known = false;        // has counted every step since zero, and was heard of just now
  bool moving = false;
  std::uint16_t flags = 0;  // wire::Flag
  std::string fault;        // why it does not move, or empty
};

class MotorDriver : public RigDriver {
 public:
  // Throws std::invalid_argument for a rig of pressure channels.
  MotorDriver(RigSettings rig, const DriverOptions& options, OpenPort open_port);

  // Here is zero. Replaces what was asked for before. Motors by name; none: all.
  void zero(const std::vector<std::string>& names = {});
  std::vector<MotorStatus> motors() const;

 protected:
  double target_of(int motor, double value) const override;
  std::int32_t on_wire(int motor, double target) const override;
  std::string words_of_flags(std::uint16_t flags) const override;
  void on_ready() override;
  void on_report(const DriveReport& report) override;
  void on_done(const BoardRequest& request) override;

 private:
  std::array<double, wire::max_motors> spool_steps_{};
  bool zero_at_start_due_;
};

}  // namespace soft_robot_lab
