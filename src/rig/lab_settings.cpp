#include "rig/lab_settings.h"

namespace soft_robot_lab {

LabFiles read_lab_files(const SettingsNode& node, const ExperimentContext& context) {
  const auto file = [&](const std::string& key) { return context.config_folder + "/" + node.text(key); };
  const std::string robot = file("robot");
  const RigSettings rig = load_rig(file("rig"));
  const RealitySettings reality = load_reality(file("reality"));
  const CameraRig cameras = read_camera_rig(file("cameras"));
  const TrackerSettings tracker = load_tracker(file("tracker"));
  const BallPlacement balls = read_ball_placement(file("balls"));
  LabFiles files{robot, {rig, reality, cameras, tracker}, balls};
  files.lab.frames = node.integer("frames", 1, 1000);
  return files;
}

}  // namespace soft_robot_lab
