// SPDX-License-Identifier: BSD-3-Clause
// Blind pockets that open downwards, against the direction in which a robot leaves its mould: cores of the mould stand
// in them. No air gets to their roofs while the robot is lifted.
#pragma once

#include <vector>

#include "ray_tree.h"

namespace soft_robot_lab {

struct Pocket {
  double roof_area_m2 = 0;                         // across the direction
  double depth_m = 0;                              // of the core: from its top down to where air comes in
  double width_m = 0;                              // of the largest circle in the roof's outline
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();  // of the roof, in the middle of that circle
};

struct Pockets {
  std::vector<Pocket> pockets;  // the largest roof first
  double footprint_m2 = 0;      // of the robot across the direction
  double wall_area_m2 = 0;      // of the footprint outside of all pockets: what carries the pull
};

// A height map of the robot seen from below, 512 cells along its longer side; a pocket is what lies higher than every
// way out at its height. Pockets less deep than `least_depth_m` are not counted.
Pockets find_pockets(const RayTree& tree, const Eigen::Vector3d& direction, double least_depth_m);

constexpr double kAtmosphere_pa = 101325;
double suction_n(const Pocket& pocket);

}  // namespace soft_robot_lab
