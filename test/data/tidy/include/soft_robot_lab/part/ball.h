// SPDX-License-Identifier: BSD-3-Clause
// A name that src/part/shape.h has with another meaning.
#pragma once

namespace soft_robot_lab {

struct Ball {
  double radius_m = 0.0;
};

}  // namespace soft_robot_lab
