// SPDX-License-Identifier: BSD-3-Clause
// Any bytes whatever to the reader of VTK files. Aborts where a rule is broken.
#pragma once

#include <cstddef>
#include <cstdint>

namespace soft_robot_lab {

void fuzz_vtk(const std::uint8_t* data, std::size_t size);

}  // namespace soft_robot_lab
