// SPDX-License-Identifier: BSD-3-Clause
// L6470s in a daisy chain on SPI. Each time the select line is low, one byte per chip goes round; chips act when it
// rises.
//
//   MOSI -> chip 0 -> chip 1 -> ... -> chip n-1 -> MISO       so the last chip's byte is sent, and received, first
#pragma once

#include <stdint.h>

#include "hardware/motor/wire.h"

namespace soft_robot_lab {
namespace chain {

void start();     // finds the chips
uint8_t count();  // 0 to 6

// The same to all chips in the mask; the others are left alone.
void command(uint8_t mask, uint8_t command);
void set(uint8_t mask, uint8_t address, uint32_t value);
void go_to(uint8_t mask, const int32_t (&positions)[wire::max_motors]);

// From all chips at once.
void get(uint8_t address, uint32_t (&values)[wire::max_motors]);
void get_positions(int32_t (&positions)[wire::max_motors]);
void clear_status(uint8_t mask);

}  // namespace chain
}  // namespace soft_robot_lab
