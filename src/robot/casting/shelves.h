// SPDX-License-Identifier: BSD-3-Clause
// Sheaths that lie in the mould while the silicone cures. A sheath would be an undercut; so the mould has a fin below
// it, the shelf, and slots above it through whatever teeth of its own it crosses. Metres, frame: robot_base.
#pragma once

#include <string>
#include <vector>

#include "ray_tree.h"
#include "robot/design/casting_settings.h"
#include "sheaths.h"
#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

// A sheath as it is cut: from skin to skin, across gaps of the robot no longer than `longest_slot_m`.
struct SheathPiece {
  std::string cable;
  std::vector<Eigen::Vector3d> points_m;  // its ends, and where it bends
  std::vector<Eigen::Vector3d> swept_m;   // the same, through slanting skin at its ends
  double radius_m = 0;                    // of the sheath
  double in_teeth_m = 0;                  // length outside the robot

  double length_m() const;
};

// Along each path, what lies inside the robot.
std::vector<SheathPiece> sheath_pieces(const RayTree& robot, const std::vector<SheathPath>& paths,
                                       double longest_slot_m);

// How far apart sheaths are as seen along the direction: where they overlap, none can lie below the other. Infinite for
// fewer than two.
WorstAlong nearest_footprints(const std::vector<SheathPath>& paths, const Eigen::Vector3d& direction);

// The sheath's least angle to the direction that it would leave the mould in; 90 where it lies level.
WorstAlong steepest_sheath(const std::vector<SheathPath>& paths, const Eigen::Vector3d& direction);  // worst_m: degrees

constexpr double kSteepest_deg = 45;  // a sheath that stands more upright does not lie on a shelf

// Where the mould's floor and open top are, along the direction.
struct MouldHeights {
  double floor_m = 0, top_m = 0;
};

// R': the robot less its sheaths, swept against the direction down to the floor. Their upper halves stay as roofs.
Solid less_swept_sheaths(const Solid& robot, const std::vector<SheathPiece>& pieces, const Eigen::Vector3d& direction,
                         const MouldHeights& heights, double clearance_m);

// What silicone and sheaths fill: the robot less the shelves, and slots up to the top through the mould's teeth. A
// shelf is as wide as its seat, whose edges end 30 degrees beside its lowest line: full half-rounds would leave rims of
// no thickness. In the teeth seats are half-round.
Solid cast_on_shelves(const Solid& robot, const std::vector<SheathPiece>& pieces, const Eigen::Vector3d& direction,
                      const MouldHeights& heights, double clearance_m);

// Silicone in the slots, above the sheaths: to be cut off.
double flash_m3(const std::vector<SheathPiece>& pieces, const Eigen::Vector3d& direction, const MouldHeights& heights,
                double clearance_m);

}  // namespace soft_robot_lab
