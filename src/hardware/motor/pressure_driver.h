// SPDX-License-Identifier: BSD-3-Clause
// Drives a rig of pressure channels: commands are gauge pressures [Pa]. A fault of one channel depressurises all of
// them, and the board takes no new set point until it is cleared.
#pragma once

#include <string>
#include <vector>

#include "rig_driver.h"

namespace soft_robot_lab {

struct PressureStatus {
  double pressure_pa = 0.0;   // measured, gauge
  double set_point_pa = 0.0;  // the board's, or one that is on its way to it
  bool known = false;         // measured, and heard of just now
  bool settling = false;      // farther from the set point than tolerance_pa, or about to be
  std::uint16_t flags = 0;    // wire::Flag, wire::PressureFlag
  std::string fault;          // why it takes no command, or empty
};

class PressureDriver : public RigDriver {
 public:
  // Throws std::invalid_argument for a rig of motors.
  PressureDriver(RigSettings rig, const DriverOptions& options, OpenPort open_port);

  std::vector<PressureStatus> channels() const;

 protected:
  double target_of(int channel, double value) const override;
  std::int32_t on_wire(int channel, double target) const override;
  std::string words_of_flags(std::uint16_t flags) const override;
  std::string fault_of(int channel) const override;
};

}  // namespace soft_robot_lab
