// SPDX-License-Identifier: BSD-3-Clause
// A surface as it is seen from above at a slant, for the instructions.
#pragma once

#include <functional>
#include <string>

#include "surface.h"

namespace soft_robot_lab {

struct Paint {
  double red = 0.62, green = 0.68, blue = 0.75;  // in full light
};

// The bytes of a PNG. The surface's third axis is up; its edges are drawn dark. Throws std::runtime_error.
std::string picture_png(const Surface& surface, const Paint& paint);

// Of each triangle its own paint.
std::string picture_png(const Surface& surface, const std::function<Paint(int)>& paint_of);

}  // namespace soft_robot_lab
