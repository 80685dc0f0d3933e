// SPDX-License-Identifier: BSD-3-Clause
#include "pressure_session.h"

#include <algorithm>

namespace soft_robot_lab {

PressureSession::PressureSession(const std::string& rig_file, std::uint64_t seed, const std::string& program)
    : LockStepSession(rig_file, seed, program), settings(load_rig(rig_file)) {
  start_driver();
}

void PressureSession::start_driver() {
  DriverOptions options;
  options.first_session = ++drivers_;
  driver_ = std::make_unique<PressureDriver>(settings, options, rig.ports());
}

bool PressureSession::run_until_ready() {
  return run_until([this] {
    const auto channels = driver_->channels();
    return std::all_of(channels.begin(), channels.end(), [](const PressureStatus& channel) { return channel.known; });
  });
}

}  // namespace soft_robot_lab
