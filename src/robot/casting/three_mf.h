// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "surface.h"

namespace soft_robot_lab {

// The content of a 3MF file (3MF Core Specification 1.2) with one object of that name, in millimetres. Corners that
// facets share are written once. Throws std::runtime_error where lib3mf refuses the surface.
std::string three_mf(const Surface& surface, const std::string& name);

}  // namespace soft_robot_lab
