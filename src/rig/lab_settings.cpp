#include "rig/lab_settings.h"

namespace soft_robot_lab {

LabFiles read_lab_files(const SettingsNode& node, const ExperimentContext& context) {
  const auto file = [&](const std::string& key) { return context.config_folder + "/" + node.text(key); };
  LabFiles files{file("robot"),
                 {load_rig(file("rig")), load_reality(file("reality")), read_camera_rig(file("cameras")),
                  load_tracker(file("tracker"))},
                 read_ball_placement(file("balls"))};
  files.lab.frames = node.integer("frames", 1, 1000);
  return files;
}

}  // namespace soft_robot_lab
