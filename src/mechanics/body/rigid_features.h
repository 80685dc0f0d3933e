// SPDX-License-Identifier: BSD-3-Clause
// What a rigid shape touches with.
#pragma once

#include <vector>

#include "gap.h"
#include "rigid_places.h"

namespace soft_robot_lab {

struct Features {
  std::vector<RoundedPoint> points;
  std::vector<RoundedRim> rims;
  std::vector<RoundedLine> lines;
};

// Of a mesh with its edges; of a plane none.
Features features_of(const ObstacleShape& shape);

// Of the middle of a ball.
Gap gap_of_ball(const ObstacleShape& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& point_m,
                double radius_m);
// A radius of a rim, by its angle from one that goes `across`.
Eigen::Vector3d radius_at_m(const RoundedRim& rim, const Eigen::Vector3d& across, double angle_rad);

// As apart_m of convex shapes, after so many cuts; of others where they overlap no less deep than this is below zero.
double apart_by_cuts_m(const PlacedShape& one, const PlacedShape& other, int cuts);

}  // namespace soft_robot_lab
