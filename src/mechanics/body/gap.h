// SPDX-License-Identifier: BSD-3-Clause
// How far a point is from a rigid shape. All shapes are exact distances outside, so that the gap is C1 there; inside it
// is C1 to the depth stated at each shape, and beyond only continuous.
//   plane                everywhere
//   sphere, capsule      to the centre, or the axis
//   cylinder, box        to the depth of the rounding near edges; else to the depth where another side is nearer
//   mesh                 to a quarter of the rounding, and as far outside; farther off it is no more than the distance
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "soft_robot_lab/mechanics/obstacle.h"

namespace soft_robot_lab {

struct Gap {
  double gap_m = 0.0;                                 // negative inside
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();   // its gradient, of length 1, out of the obstacle
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();  // its second derivative [1/m]
};

Gap gap_to(const ObstacleShape& shape, const Eigen::Vector3d& point_m);

bool is_flat(const ObstacleShape& shape);  // a body stands on it with its foot: planes and boxes, and meshes like these

// What an obstacle turns about. Of a plane its point, of a mesh its centroid, else the middle.
Eigen::Vector3d center_m(const ObstacleShape& shape);

// The pose of anything that moves so about this centre.
Eigen::Isometry3d pose_at(const std::vector<ObstaclePose>& motion, const Eigen::Vector3d& center_m, double time_s);

// From the shape as stated to where it stands.
Eigen::Isometry3d pose_at(const Obstacle& obstacle, double time_s);

// What leads from one time of such a motion to another.
Eigen::Isometry3d way_between(const std::vector<ObstaclePose>& motion, const Eigen::Vector3d& center_m, double from_s,
                              double to_s);

double end_of_motion_s(const std::vector<Obstacle>& obstacles);
bool any_moves_between(const std::vector<Obstacle>& obstacles, double from_s, double to_s);

// What takes all that moves with a centre along: it moves, and turns by an axis times an angle.
Eigen::Isometry3d moved_about(const Eigen::Vector3d& center_m, const Eigen::Vector3d& way_m,
                              const Eigen::Vector3d& turn_rad);

Eigen::Vector3d turn_rad(const Eigen::Isometry3d& way);  // axis times angle

// The gap to the shape where it stands.
Gap gap_to(const ObstacleShape& shape, const Eigen::Isometry3d& pose, const Eigen::Vector3d& point_m);

}  // namespace soft_robot_lab
