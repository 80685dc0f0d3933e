// SPDX-License-Identifier: BSD-3-Clause
// The files of a rig as text: what drives a robot's actuators, how the robot on the rig differs from its model, how its
// markers look, and where balls stand.
#pragma once

#include <string>
#include <vector>

#include "perception/calibration/calibration.h"
#include "perception/render/camera_setup.h"
#include "soft_robot_lab/mechanics/simulation.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// What one motor of the rig moves, or one pressure channel fills.
struct Driven {
  std::string name;                         // of the actuator
  std::string section;                      // of the robot's file that it stands in: cables, chambers or actuators
  std::string model;                        // the law of a cable: sliding, friction or springs
  bool syringe = false;                     // else a cable, or
  bool air = false;                         // a chamber by gauge pressure
  double rest_length_m = 0;                 // of a cable
  double min_command = 0, max_command = 0;  // contractions, ml of the plunger's travel, or Pa
  double speed = 0;                         // of the drive [m/s] or [ml/s]; 0: the robot's file has no limit
  bool delayed = false;                     // the robot's file lets its drive start late
  double friction_coefficient = 0, compliance_m_n = 0, length_offset_m = 0, tube_volume_ml = 0;  // of the model
};

// The robot's actuators in their order, as motors move them. `robot`: its file with what it includes. Throws
// SettingsError, or std::invalid_argument: no actuators, more than a board has motors or channels, one that neither
// moves, one whose file states no limit, some for motors and some for air.
std::vector<Driven> driven_actuators(const YamlNode& robot, const Simulation& simulation);

// `name`: the robot's, for comments. `include`: the robot's file as the plant's names it.
std::string motors_text(const std::string& name, const std::vector<Driven>& drives);
bool by_air(const std::vector<Driven>& drives);  // then its rig is
std::string pressures_text(const std::string& name, const std::vector<Driven>& drives);
std::string plant_text(const std::string& name, const std::string& include, const YamlNode& robot,
                       const Simulation& simulation, const std::vector<Driven>& drives, const CameraSetup& cameras);
// By the stickers of `cameras`. Throws std::invalid_argument where one is too grey or too dark to be found by colour.
std::string tracker_text(const std::string& name, const std::vector<std::string>& markers, const CameraSetup& cameras);
std::string balls_text(const std::string& name, const BallPlacement& placement);
// Where cameras stand, as if they were calibrated exactly.
std::string poses_text(const CameraSetup& cameras);

}  // namespace soft_robot_lab
