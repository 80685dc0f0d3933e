// SPDX-License-Identifier: BSD-3-Clause
// What a rigid shape touches with.
#pragma once

#include <vector>

#include "rigid_places.h"

namespace soft_robot_lab {

struct Features {
  std::vector<RoundedPoint> points;
  std::vector<RoundedRim> rims;
  std::vector<RoundedLine> lines;
};

// Of a mesh with its edges; of a plane none.
Features features_of(const ObstacleShape& shape);

// As apart_m of convex shapes, after so many cuts; of others where they overlap no less deep than this is below zero.
double apart_by_cuts_m(const PlacedShape& one, const PlacedShape& other, int cuts);

}  // namespace soft_robot_lab
