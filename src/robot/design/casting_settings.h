// SPDX-License-Identifier: BSD-3-Clause
// `casting` of a robot's file: the limits that a castable robot keeps, and what its mould may have.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/robot/design/solid.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

struct SheathSettings {
  double radius_m = 0.001;        // a straw of 2 mm, as the source's
  double wall_m = 0.0005;         // silicone around it, at least
  bool shelf = false;             // it lies in the mould while the silicone cures
  double clearance_m = 0.0001;    // around it on its shelf
  double longest_slot_m = 0.005;  // a sheath ends at wider gaps of the robot
};

// What a mould is made with.
struct MouldSettings {
  bool allow_two_part = false, allow_lid = false;
  double wall_m = 0.004;              // of the block around the robot, of its floor, and of half a flange
  double min_wall_m = 0.0012;         // of the mould anywhere: three lines of a nozzle of 0.4 mm
  double flange_m = 0.012;            // width, on both sides of a parting plane
  double bolt_radius_m = 0.0022;      // holes for M4
  double key_radius_m = 0.0025;       // pegs of one half
  double clearance_m = 0.0002;        // of their sockets in the other
  double air_hole_radius_m = 0.0005;  // of vents too
  double sprue_radius_m = 0.004;      // where it meets the cavity
  double part_a_fraction = 0.5;       // of the silicone's mass
  double spare_fraction = 0.1;        // more silicone than the cavity holds
  Eigen::Vector3d printer_m{0.223, 0.223, 0.205};
};

// Defaults and their reasons: config/README.md, "Casting".
struct CastingSettings {
  std::optional<Eigen::Vector3d>
      direction;  // unit, in which the robot leaves its mould; without one the best is sought
  double min_thickness_m = 0.002;
  double min_angle_deg = 15;
  double notch_radius_m = 0.0005;  // what is rounded by less counts as sharp
  double min_draft_deg = 0;
  double max_stretch = 1.5;
  double min_radius_m = 0.013;  // of a cable's bends
  double max_suction_strain = 0.25;
  double max_core_aspect = 5;
  bool air_holes = false;
  std::vector<Solid> inserts;  // made apart, and bonded into the robot: taken away from what is cast
  SheathSettings sheath;
  MouldSettings mould;
};

// Of the whole robot's file, which may have none. Throws SettingsError.
CastingSettings read_casting_settings(const YamlNode& robot);

}  // namespace soft_robot_lab
