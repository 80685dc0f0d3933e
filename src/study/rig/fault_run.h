// SPDX-License-Identifier: BSD-3-Clause
// Random commands to an emulated rig whose line damages bytes, whose plug is pulled and whose board is reset: is the
// position exact whenever the driver says that it knows it?
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "hardware/motor/rig_settings.h"

namespace soft_robot_lab {

struct FaultRunOptions {
  int commands = 10000;
  double corrupted = 0.01, lost = 0.01, doubled = 0.01;  // chances of each byte, both ways
  int unplugs = 10;
  int resets = 3;      // of the board alone: the stepper drivers keep their positions
  int brown_outs = 1;  // of board and drivers: positions are lost
  std::uint64_t seed = 1;
  std::string emulator;                  // as in Testbench
  std::function<void(double)> progress;  // share done
};

struct FaultRunResult {
  std::int64_t commands = 0, acknowledged = 0, superseded = 0, refused = 0;
  std::int64_t corrupted = 0, lost = 0, doubled = 0;  // bytes
  int unplugs = 0, resets = 0, brown_outs = 0;
  std::int64_t checks = 0;           // of a motor at rest with a known position against its shaft
  std::int64_t wrong_unflagged = 0;  // of these: elsewhere than said, or than the last command asked for
  std::int64_t unknown_declared = 0;
  std::int64_t unaccounted = 0;
  std::int64_t stuck = 0;  // waits for rest that did not end
  double emulated_s = 0.0;
};

FaultRunResult run_with_faults(const RigSettings& rig, const FaultRunOptions& options);

}  // namespace soft_robot_lab
