// SPDX-License-Identifier: BSD-3-Clause
// What each pressure channel is asked for, has, and suffers. A fault of one depressurises all: with one chamber empty
// the others push the robot where nobody asked it to go, and the supply that they share is shut, which alone empties a
// channel whose valve is stuck open.
#pragma once

#include <stdint.h>

#include "hardware/motor/wire.h"

namespace soft_robot_lab {
namespace pressures {

void start();
void tick(uint16_t now_ms);  // every millisecond
void set_count(uint8_t channels);
uint8_t count();

// Requests of the host. A mask is done as a whole or not at all.
wire::Result configure(const uint8_t* payload);  // as laid out in wire::channel
wire::Result go_to(uint8_t mask, const uint8_t* set_points);
wire::Result vent(uint8_t mask);
wire::Result clear(uint8_t mask);
void emergency_stop();
void stop_for_silence();

bool take_arrived(uint8_t channel);  // true once after a channel came near its set point
uint16_t flags(uint8_t channel);
int32_t pressure_pa(uint8_t channel);
int32_t set_point_pa(uint8_t channel);
const uint8_t* configuration(uint8_t channel);  // as given, or zeros

}  // namespace pressures
}  // namespace soft_robot_lab
