// SPDX-License-Identifier: BSD-3-Clause
// Bytes that are bad or extreme, each in one way, made from good ones: of messages, of records of a bag.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace soft_robot_lab {

struct BadBytes {
  std::string name;  // what was done, and where
  std::vector<std::uint8_t> bytes;
};

// At every place a number (of 8 or of 4 bytes, which may be a list's or a text's length) replaced by each of a list of
// bad ones, and the end cut off; then bytes replaced at random places, and some added. The same seed makes the same.
std::vector<BadBytes> bad_bytes(const std::vector<std::uint8_t>& good, unsigned int seed);

}  // namespace soft_robot_lab
