// SPDX-License-Identifier: BSD-3-Clause
// The USB serial line: bytes through two rings, sent and received by interrupts, so nothing ever waits.
#pragma once

#include <stdint.h>

namespace soft_robot_lab {
namespace serial {

void start();
bool read(uint8_t& byte);  // false when there is none
bool has_input();
uint8_t room();                                   // bytes that write() takes now
void write(const uint8_t* bytes, uint8_t count);  // count <= room()

}  // namespace serial
}  // namespace soft_robot_lab
