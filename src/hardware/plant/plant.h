// SPDX-License-Identifier: BSD-3-Clause
// A robot that is not quite its model: a second simulation that plays plant, whose cables the shafts of an emulated
// rig pull. How it differs stands in config/robots/*/plant.yaml, which no controller or tracker reads.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "perception/render/camera_setup.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// By how much a camera was displaced out of the place that is believed. In the world, the turn about where it stands.
struct CameraShift {
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_deg = Eigen::Vector3d::Zero();  // axis times angle
};

// robot:                # a scene (config/README.md, "Scene"): the model with what is otherwise
//   include: ../robots/spinebot/robot.yaml
//   body: {material: {stiffness_ratio: 1.15}}
//   cables: {left: {model: friction, friction_coefficient: 0.1}}
// backlash_steps: {left: 4}                                        # optional, full steps by actuator
// cameras: {camera_left: {translation_m: [x, y, z], rotation_deg: [x, y, z]}}   # optional, by a camera's name
struct PlantSettings {
  YamlNode robot;
  std::map<std::string, double> backlash_steps;
  std::map<std::string, CameraShift> cameras;

  // Cameras as they really stand where they are believed to stand as `believed` says. Throws std::invalid_argument for
  // a camera that there is not.
  CameraSetup shifted(CameraSetup believed) const;
};

PlantSettings load_plant(const std::string& path);  // throws SettingsError

class Plant {
 public:
  // Hangs at rest. Throws SettingsError, and std::runtime_error where it finds no rest. `ends`: as Simulation's
  // interrupt.
  Plant(const PlantSettings& settings, const SceneOptions& options, std::function<bool()> ends = {});

  // Lets time pass, in whole time steps of the scene; what is left over counts next time. `values`: where the drives
  // are now, behind their backlash, as contractions (ShaftState's); actuators not named stay. Throws
  // std::invalid_argument naming actuator, value and allowed range, and nothing moves then.
  void advance(double duration_s, const std::vector<std::string>& names, const std::vector<double>& values);

  // What acts on the robot from outside, in place of what acted before, as Simulation::pull.
  void load(const std::vector<PointLoad>& loads) { simulation_->pull(loads); }
  Simulation& pushed() { return *simulation_; }  // for a hand that looks for its place on the skin first

  const Simulation& simulation() const { return *simulation_; }
  const SimulationState& previous() const { return previous_; }  // a time step before the present one
  const SimulationState& present() const { return simulation_->state(); }
  std::map<std::string, Eigen::Vector3d> markers_m() const;  // true places, robot_base
  // Time steps that did not converge, or ended with inverted elements.
  int failed_steps() const { return failed_steps_; }

 private:
  std::unique_ptr<Simulation> simulation_;
  SimulationState previous_;
  double ahead_s_ = 0.0;  // time that has passed beyond the last step
  int failed_steps_ = 0;
};

}  // namespace soft_robot_lab
