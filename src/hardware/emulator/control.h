// SPDX-License-Identifier: BSD-3-Clause
// One line of text, one line of answer: how tests, nodes and people ask the emulated rig for faults and for the truth.
// The commands are listed in src/hardware/firmware/PROTOCOL.md.
#pragma once

#include <string>

#include "emulated_rig.h"

namespace soft_robot_lab {

// "ok ..." or "error ...". `run` is taken only where time is the asker's.
std::string answer(EmulatedRig& rig, const std::string& line, bool lock_step);

}  // namespace soft_robot_lab
