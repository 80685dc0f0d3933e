// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "surface.h"

namespace soft_robot_lab {

// The content of a binary STL file in millimetres, which begins with a title of at most 80 letters.
std::string binary_stl(const Surface& surface, const std::string& title);

}  // namespace soft_robot_lab
