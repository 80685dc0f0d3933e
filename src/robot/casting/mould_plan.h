// SPDX-License-Identifier: BSD-3-Clause
// Of which solids a robot's mould consists: one open block, two halves that part at a plane, or what lid_plan.h makes.
// See README.md beside this file. Metres, frame: robot_base.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "cast_robot.h"
#include "extraction.h"
#include "shelves.h"
#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

// A good file of a robot for which no mould is made; what() names the reason, and what would help.
class NoMould : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct MouldPiece {
  std::string name;
  Solid solid;
  Eigen::Matrix3d to_print;                 // turns it as it stands on the printer's bed
  Eigen::Vector3d size_m;                   // along the mould's axes
  Eigen::Vector3d form_low_m, form_high_m;  // of what forms silicone, along these axes
  bool in_block = true;                     // counts in the closure of volumes
};

struct AirHole {
  Eigen::Vector3d from_m, to_m;  // from the top of a core to below the floor
};

// A round way out of two halves' cavity, in their parting plane, which silicone fills.
struct Channel {
  Eigen::Vector3d from_m, to_m;  // from the cavity's skin to open air, or to silicone above
  double radius_m = 0, end_radius_m = 0;
};

struct MouldPlan {
  bool two_part = false, lid = false;
  // Axes of the mould as columns: across both others, the way in which the halves part, up while the silicone cures.
  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  // in which the robot, or the second half, leaves
  Eigen::Vector3d low_m, high_m;                         // of the robot, along these axes
  double parting_m = 0;                                  // of two parts: along the second axis
  double top_area_m2 = 0;                                // open to air
  double rim_m = 0;                                      // where the silicone is open to air, along the third axis
  double first_pour_m3 = 0;                              // of a robot with a lid: all but the lid
  std::vector<AirHole> air_holes;
  std::vector<Channel> vents;        // of two halves: where air would be caught
  std::optional<Channel> sprue;      // of two halves that no flat side of the robot keeps open
  std::vector<SheathPiece> sheaths;  // that lie in it
  double flash_m3 = 0;               // silicone above them in slots through the mould's teeth
  Solid cast;                        // what silicone and sheaths fill, vents and sprue too; without names
  int bolts = 0, keys = 0;
  int inserts = 0;             // pieces that are made apart
  double block_volume_m3 = 0;  // closed form: all pieces that count together with the robot
  std::vector<MouldPiece> pieces;
};

// Lengthwise along the printer's axes, in any order.
bool fits_printer(Eigen::Vector3d size_m, Eigen::Vector3d room_m);

// Two halves along which of the axes, and where: a plane such that no skin above it faces down and none below it up.
// The least deep robot with an open top comes first. Throws NoMould.
struct Parting {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  double offset_m = 0;
  std::optional<HullPlane> top;  // at right angles to the direction, stays open for pouring; none: it needs a sprue
};
Parting find_parting(const CastShape& robot);

// What the programs say of a robot, and the mould that they make of it: none where the verdict is not castable.
struct JudgedMould {
  CastingVerdict verdict;
  std::optional<MouldPlan> plan;
};

// With the file's verdict about one block, as check_casting gives it. Tests that two halves or a lid let pass, which
// `casting.allow` names, say so in `by`; where it does not name them, or no such mould is made, `why` says that. A
// castable robot of which no mould is made fails the added test `mould`. A piece that the printer has no room for is
// refused here, before it is meshed. Throws std::invalid_argument where the body is not made of shapes and STEP.
JudgedMould judge_mould(const CastRobotFile& file, CastingVerdict verdict);

// Throws as judge_mould, and NoMould with the reasons of all tests that fail.
MouldPlan plan_mould(const CastRobotFile& file, const CastingVerdict& verdict);

// The verdict of judge_mould; as it is of other bodies, which get no mould.
CastingVerdict with_allowed_moulds(const CastRobotFile& file, CastingVerdict verdict);

}  // namespace soft_robot_lab
