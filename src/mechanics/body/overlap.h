// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// Throws std::invalid_argument where one of the obstacles, at the start of its motion, is inside the body: name, depth
// and place; or where a free one is inside another. Rounding of the mesh is let through.
void refuse_overlap(const Body& body, const std::vector<Obstacle>& obstacles);

// The same of two bodies of its mesh.
void refuse_overlap(const Body& body, int first, int second);

}  // namespace soft_robot_lab
