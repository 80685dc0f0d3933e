// SPDX-License-Identifier: BSD-3-Clause
// Any bytes whatever, to the frame decoder and to the host's end of a session. Aborts where a rule is broken.
#pragma once

#include <cstdint>
#include <cstddef>

namespace soft_robot_lab {

void fuzz_protocol(const std::uint8_t* input, std::size_t size);

}  // namespace soft_robot_lab
