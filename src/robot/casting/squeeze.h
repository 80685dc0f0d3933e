// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "surface.h"

namespace soft_robot_lab {

struct Squeeze {
  double stretch = 1;   // what must pass over the opening it passes: 1 where nothing is in the way
  double height_m = 0;  // of the wide place, along the direction
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
};

// How much a soft robot has to give way on leaving its mould: widths of its sections across the direction, in eighteen
// ways, against the narrowest above. It knows no holes, and no ways but outlines.
Squeeze needed_stretch(const Surface& surface, const Eigen::Vector3d& direction);

}  // namespace soft_robot_lab
