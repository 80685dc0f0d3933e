// SPDX-License-Identifier: BSD-3-Clause
#include "pressure_driver.h"

#include <cmath>
#include <stdexcept>

#include "words.h"

namespace soft_robot_lab {

PressureDriver::PressureDriver(RigSettings rig, const DriverOptions& options, OpenPort open_port)
    : RigDriver(std::move(rig), options, std::move(open_port)) {
  if (this->rig().channels.empty())
    throw std::invalid_argument("channels: missing; a rig of motors has another driver");
}

double PressureDriver::target_of(int, double value) const { return std::round(value); }

std::int32_t PressureDriver::on_wire(int, double target) const { return static_cast<std::int32_t>(target); }

std::string PressureDriver::words_of_flags(std::uint16_t flags) const { return words_of_pressure_flags(flags); }

std::string PressureDriver::fault_of(int channel) const {
  std::string own = RigDriver::fault_of(channel);
  if (!own.empty()) return own;
  for (std::size_t i = 0; i < count(); ++i)
    if (drive(i).report && (drive(i).report->flags & wire::fault_flags) != 0)
      return "let out, as " + rig().channels[i].name + " has a fault: clear it first";
  return "";
}

std::vector<PressureStatus> PressureDriver::channels() const {
  std::vector<PressureStatus> all;
  for (std::size_t i = 0; i < count(); ++i) {
    const DriveReport& last = drive(i).last;
    const std::optional<double> asked = asked_target(i);
    PressureStatus status;
    status.pressure_pa = last.position;
    status.set_point_pa = asked.value_or(last.target);
    status.flags = last.flags;
    status.known = ready() && (last.flags & wire::flag_known) != 0;
    status.settling = (last.flags & wire::flag_moving) != 0 || asked;
    status.fault = fault_of(static_cast<int>(i));
    all.push_back(status);
  }
  return all;
}

}  // namespace soft_robot_lab
