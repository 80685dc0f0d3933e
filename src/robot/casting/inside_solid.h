// SPDX-License-Identifier: BSD-3-Clause
// Whether a point lies in a solid, by its shapes' own equations: a second opinion on what the geometry kernel made of
// it.
#pragma once

#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

// Of files there are no equations here: false where the solid holds a STEP or STL file.
bool has_equations(const Solid& solid);

// Metres. Throws std::invalid_argument where has_equations() is false.
bool contains(const Solid& solid, const Eigen::Vector3d& point_m);

}  // namespace soft_robot_lab
