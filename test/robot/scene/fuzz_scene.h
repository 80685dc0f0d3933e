// SPDX-License-Identifier: BSD-3-Clause
// Any text whatever as a scene on a small mesh. Aborts where a rule is broken.
#pragma once

#include <cstddef>
#include <cstdint>

namespace soft_robot_lab {

void fuzz_scene(const std::uint8_t* data, std::size_t size);

}  // namespace soft_robot_lab
