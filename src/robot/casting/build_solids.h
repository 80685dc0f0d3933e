// SPDX-License-Identifier: BSD-3-Clause
// Shapes that moulds are made of.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

// A box from corner to corner in a mould's axes, which are the frame's columns and lie along the robot's.
inline Solid block(const Eigen::Matrix3d& frame, const Eigen::Vector3d& low_m, const Eigen::Vector3d& high_m) {
  Solid solid;
  solid.size_m = (frame * (high_m - low_m)).cwiseAbs();
  solid.center_m = frame * (low_m + high_m) / 2;
  return solid;
}

inline Solid combined(Solid::Kind kind, std::vector<Solid> parts) {
  Solid solid;
  solid.kind = kind;
  solid.parts = std::move(parts);
  return solid;
}

inline Solid round_bar(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, double radius_m,
                       double end_radius_m) {
  Solid solid;
  solid.kind = radius_m == end_radius_m ? Solid::Kind::cylinder : Solid::Kind::cone;
  solid.start_m = from_m;
  solid.end_m = to_m;
  solid.radius_m = radius_m;
  solid.end_radius_m = end_radius_m;
  return solid;
}

inline Solid round_bar(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m, double radius_m) {
  return round_bar(from_m, to_m, radius_m, radius_m);
}

inline bool holds_stl(const Solid& solid) {
  return solid.kind == Solid::Kind::stl_file || std::any_of(solid.parts.begin(), solid.parts.end(), holds_stl);
}

}  // namespace soft_robot_lab
