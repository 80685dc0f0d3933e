// SPDX-License-Identifier: BSD-3-Clause
// Results and flags of the protocol in words.
#pragma once

#include <cstdint>
#include <string>

#include "wire.h"

namespace soft_robot_lab {

std::string words(wire::Result result);
std::string words_of_firmware(std::uint8_t firmware);  // what a board drives
std::string words_of_flags(std::uint16_t flags);       // why a motor does not move; empty when it may
// The same of a pressure channel.
std::string words_of_pressure_flags(std::uint16_t flags);

}  // namespace soft_robot_lab
