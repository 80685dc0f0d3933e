// SPDX-License-Identifier: BSD-3-Clause
// What of a mould stands in a robot from below, against the direction in which it leaves: cores, in blind pockets and
// in holes through it. No air gets to the roofs of pockets while the robot is lifted.
#pragma once

#include <limits>
#include <vector>

#include "ray_tree.h"

namespace soft_robot_lab {

// Skin that looks down on a core.
struct Pocket {
  double roof_area_m2 = 0;                         // across the direction
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();  // of the roof, in the middle of the largest circle in its outline
};

// Where it is slimmest: of all parts of it above some height the one that is highest for its width there.
struct Core {
  bool through = false;  // it stands in a hole through the robot
  double height_m = 0;   // from there to its top; at its foot: from where air comes in
  double width_m = std::numeric_limits<double>::infinity();  // there, of the largest circle between its walls
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();            // its top, over the middle of that circle

  double aspect() const { return height_m / width_m; }
};

struct Pockets {
  std::vector<Pocket> pockets;  // the largest roof first
  std::vector<Core> cores;      // the slimmest first
  double footprint_m2 = 0;      // of the robot across the direction
  double wall_area_m2 = 0;      // of the footprint outside of all pockets: what carries the pull
};

// A height map of the robot seen from below; a core is what lies higher than every way out at its height, or is a hole
// through the robot. Beside such a hole only skin that looks down counts as a roof, not its walls. Less than
// `least_depth_m` is not counted. What lies above `top_m` along the direction is left out.
Pockets find_pockets(const RayTree& tree, const Eigen::Vector3d& direction, double least_depth_m,
                     double top_m = std::numeric_limits<double>::infinity());

constexpr double kAtmosphere_pa = 101325;
double suction_n(const Pocket& pocket);

}  // namespace soft_robot_lab
