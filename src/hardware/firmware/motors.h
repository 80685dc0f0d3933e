// SPDX-License-Identifier: BSD-3-Clause
// What each motor is asked to do, does, and has suffered. A motor moves only while it is configured, its position is
// known, no fault is latched and no emergency stop is on.
#pragma once

#include <stdint.h>

#include "hardware/motor/wire.h"

namespace soft_robot_lab {
namespace motors {

void start();  // reads back what the chips still know, and stops what still moves
void poll();   // every poll_period_ms
constexpr uint8_t poll_period_ms = 2;

// Requests of the host. A mask is done as a whole or not at all.
wire::Result configure(const uint8_t* payload);  // as laid out in wire::motor
wire::Result go_to(uint8_t mask, const uint8_t* positions);
wire::Result zero(uint8_t mask);
wire::Result soft_stop(uint8_t mask);
wire::Result clear(uint8_t mask);
void emergency_stop();
void stop_for_silence();

void read_positions();
bool take_stopped(uint8_t motor);  // true once after a motor came to rest
uint16_t flags(uint8_t motor);
int32_t position(uint8_t motor);  // as of read_positions()
int32_t target(uint8_t motor);
const uint8_t* configuration(uint8_t motor);  // as given, or zeros

}  // namespace motors
}  // namespace soft_robot_lab
