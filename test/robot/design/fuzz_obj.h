// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace soft_robot_lab {

void fuzz_obj(const std::uint8_t* data, std::size_t size);

}  // namespace soft_robot_lab
