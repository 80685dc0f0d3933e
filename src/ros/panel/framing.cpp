// SPDX-License-Identifier: BSD-3-Clause
#include "framing.h"

#include <algorithm>

namespace soft_robot_lab {
namespace {

constexpr double kAbove_m = 0.04;           // scale and names (Overlay)
constexpr double kHalfAngleTangent = 0.32;  // of what rviz shows of the height, with a margin
constexpr double kAspect = 1.3;             // of the window beside the panel

}  // namespace

Framing framing_of(const Eigen::AlignedBox3d& robot_m) {
  Eigen::AlignedBox3d seen_m = robot_m;
  seen_m.max().z() += kAbove_m;
  const Eigen::Vector3d size_m = seen_m.sizes();
  const double bent_m = 1.6 * robot_m.sizes().z();  // across, of a robot that hangs
  const double half_m = 0.5 * std::max(size_m.z(), std::max(size_m.x(), bent_m) / kAspect);
  return {seen_m.center(), half_m / kHalfAngleTangent + 0.5 * size_m.y()};
}

}  // namespace soft_robot_lab
