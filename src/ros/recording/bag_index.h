// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace soft_robot_lab {

// rosbag takes every place and length that a bag names for one that it has, and reads beyond its memory where it is
// not. Throws std::runtime_error for an index that points elsewhere than to the messages of its chunk, for records,
// those within chunks too, that go beyond the end of what holds them, for chunks of more than limits::kChunk_bytes
// unpacked, and for what is no bag of version 2.0.
void require_sound(const std::string& bag);

}  // namespace soft_robot_lab
