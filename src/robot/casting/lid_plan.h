// SPDX-License-Identifier: BSD-3-Clause
// Moulds for two pours: a robot with closed cavities is parted at a plane where they end. The larger piece is cast
// around a core that hangs from a bridge; a lid is cast in a tray, and the piece is laid on it before it cures.
#pragma once

#include "mould_plan.h"

namespace soft_robot_lab {

// Where the lid begins: beyond `height_m` along a direction in which the rest leaves its mould, and its core the rest.
struct LidCut {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  double height_m = 0;
  double depth_m = 0;  // of the core
};

// Along the robot's axes, those whose cores are free to leave, the least deep first. Whether the skin is free to leave
// is not asked here.
std::vector<LidCut> lid_cuts(const Surface& robot);

// A base, a core on its bridge and a tray. `solid` has no names. Throws NoMould.
MouldPlan plan_lid(const CastRobotFile& file, const Solid& solid);

}  // namespace soft_robot_lab
