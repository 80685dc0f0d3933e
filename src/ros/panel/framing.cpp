// SPDX-License-Identifier: BSD-3-Clause
#include "framing.h"

#include <algorithm>
#include <cmath>

namespace soft_robot_lab {
namespace {

constexpr double kHalfAngleTangent = 0.31;  // of what rviz shows of the height, with room for what is written
constexpr double kLargestAspect = 1.1;      // more width is left to what is written
constexpr double kBent = 1.6;               // of its height a robot that hangs is wide, when it bends

}  // namespace

Framing framing_of(const Eigen::AlignedBox3d& robot_m, const EyeAngles& eye, double aspect) {
  aspect = std::min(aspect, kLargestAspect);
  const double level = std::cos(eye.pitch_rad);
  const Eigen::Vector3d towards(level * std::cos(eye.yaw_rad), level * std::sin(eye.yaw_rad), std::sin(eye.pitch_rad));
  const Eigen::Vector3d right(-std::sin(eye.yaw_rad), std::cos(eye.yaw_rad), 0.0), up = towards.cross(right);
  double distance_m = 0.5 * kBent * robot_m.sizes().z() / (aspect * kHalfAngleTangent);
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d way_m = robot_m.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)) - robot_m.center();
    const double half_m = std::max(std::abs(up.dot(way_m)), std::abs(right.dot(way_m)) / aspect);
    distance_m = std::max(distance_m, half_m / kHalfAngleTangent + towards.dot(way_m));
  }
  return {robot_m.center(), distance_m};
}

}  // namespace soft_robot_lab
