// SPDX-License-Identifier: BSD-3-Clause
// The ways of cables through a solid: bends, and the silicone around their sheaths.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "ray_tree.h"

namespace soft_robot_lab {

struct SheathPath {
  std::string name;
  std::vector<Eigen::Vector3d> points_m;
  double radius_m = 0.001;
};

struct WorstAlong {
  double worst_m = std::numeric_limits<double>::infinity();
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  std::string cable, other;
};

// The largest arc that fits into the sharpest bend, by half of the shorter side: infinite for straight cables.
WorstAlong tightest_bend(const std::vector<SheathPath>& paths);

// Silicone around the sheaths, across them, wherever they run inside the solid: ends within two radii of the skin are
// left out, since cables come out there.
WorstAlong thinnest_cover(const RayTree& tree, const std::vector<SheathPath>& paths);

// Silicone between two sheaths inside the solid.
WorstAlong nearest_sheaths(const RayTree& tree, const std::vector<SheathPath>& paths);

// The point of a path that lies so far along it; its last one beyond its end.
Eigen::Vector3d point_along(const std::vector<Eigen::Vector3d>& points_m, double length_m);

// Whether a point lies in the solid.
bool is_inside(const RayTree& tree, const Eigen::Vector3d& point_m);

}  // namespace soft_robot_lab
