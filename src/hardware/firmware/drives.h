// SPDX-License-Identifier: BSD-3-Clause
// What the board drives, as its session sees it: stepper motors or pressure channels. Each firmware links one of
// stepper_drives.cpp and pressure_drives.cpp; line, frames, session and watchdog are the same.
#pragma once

#include <stdint.h>

#include "hardware/motor/framing.h"

namespace soft_robot_lab {
namespace drives {

wire::Firmware firmware();
void start();
void tick(uint16_t now_ms);  // every millisecond

uint8_t capacity();                           // how many the board has, or can have
uint8_t count();                              // of those it reports
wire::Result configure_board(uint8_t count);  // takes on so many, or refuses
uint16_t configuration_crc(uint8_t drive, uint16_t crc);

wire::Result execute(const wire::Frame& request);  // all other numbered requests
void emergency_stop();
void stop_for_silence();

void measure();                    // before states are reported
bool take_arrived(uint8_t drive);  // true once after a drive came to rest
uint16_t flags(uint8_t drive);     // as wire::Flag, or wire::PressureFlag
int32_t position(uint8_t drive);   // microsteps, or Pa
int32_t target(uint8_t drive);     // likewise

}  // namespace drives
}  // namespace soft_robot_lab
