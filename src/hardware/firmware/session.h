// SPDX-License-Identifier: BSD-3-Clause
// Answers the host's frames, reports the drives' states, and stops them when the host has been silent for too long.
#pragma once

#include <stdint.h>

#include "hardware/motor/framing.h"

namespace soft_robot_lab {
namespace session {

void handle(const wire::Frame& frame);
void tick(uint16_t now_ms);  // every millisecond

}  // namespace session
}  // namespace soft_robot_lab
