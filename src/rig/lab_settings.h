// What the settings of experiments in the emulated lab have in common.
#pragma once

#include "soft_robot_lab/experiment/experiment.h"
#include "soft_robot_lab/rig/emulated_lab.h"
#include "soft_robot_lab/settings/settings_node.h"

namespace soft_robot_lab {

// robot: robots/spinebot.yaml        # the model
// reality: reality/spinebot.yaml     # all below the package's config/
// rig: rigs/spinebot.yaml
// cameras: cameras/box.yaml
// tracker: trackers/spinebot.yaml
// balls: calibration/balls_spinebot.yaml      # to calibrate the cameras by
// frames: 8                          # of each camera for a measurement
struct LabFiles {
  std::string robot;
  EmulatedLabSettings lab;
  BallPlacement balls;
};

LabFiles read_lab_files(const SettingsNode& node, const ExperimentContext& context);

}  // namespace soft_robot_lab
