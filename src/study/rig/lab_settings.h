// SPDX-License-Identifier: BSD-3-Clause
// What the settings of experiments in the emulated lab have in common.
#pragma once

#include "study/experiment.h"
#include "emulated_lab.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// robot: robots/spinebot/robot.yaml        # the model
// plant: robots/spinebot/plant.yaml     # all below the package's config/
// rig: robots/spinebot/motors.yaml
// cameras: cameras/box.yaml
// tracker: robots/spinebot/tracker.yaml
// balls: robots/spinebot/balls.yaml      # to calibrate the cameras by
// frames: 8                          # of each camera for a measurement
struct LabFiles {
  std::string robot;
  EmulatedLabSettings lab;
  BallPlacement balls;
};

LabFiles read_lab_files(const YamlNode& node, const ExperimentContext& context);

}  // namespace soft_robot_lab
