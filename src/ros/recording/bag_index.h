// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace soft_robot_lab {

// rosbag takes every place that a bag's index names for one that it has, and reads beyond its memory where it is not.
// Throws std::runtime_error for an index that points elsewhere than to the records it is about, and for records that go
// beyond the end of what holds them. What compressed chunks hold is for their own checksums to judge.
void require_sound_index(const std::string& bag);

}  // namespace soft_robot_lab
