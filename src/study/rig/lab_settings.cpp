// SPDX-License-Identifier: BSD-3-Clause
#include "lab_settings.h"

namespace soft_robot_lab {

LabFiles read_lab_files(const YamlNode& node, const ExperimentContext& context) {
  const auto file = [&](const std::string& key) { return context.config_folder + "/" + node.text(key); };
  const std::string robot = file("robot");
  const RigSettings rig = load_rig(file("rig"));
  const PlantSettings plant = load_plant(file("plant"));
  const CameraSetup cameras = read_camera_setup(file("cameras"));
  const TrackerSettings tracker = load_tracker(file("tracker"));
  const BallPlacement balls = read_ball_placement(file("balls"));
  LabFiles files{robot, {rig, plant, cameras, tracker}, balls};
  files.lab.frames = node.integer("frames", 1, 1000);
  return files;
}

}  // namespace soft_robot_lab
