// SPDX-License-Identifier: BSD-3-Clause
// A coarse bar with one cable, which bends it to one side, in one folder, so that a reduced model is trained once.
#pragma once

#include <string>

#include "robot/scene/scene_files.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

class CabledBar : public SceneFolder {
 public:
  CabledBar() {
    write("coarse.yaml", R"(include: bar.yaml
body: {element_size_m: 0.03}
cables: [{name: left, points_m: [[0, -0.007, 0], [0.1, -0.007, 0]], via_points: given, sheath_radius_m: 0.001, plug_radius_m: 0.003}]
)");
  }

  // `text` follows the include.
  Scene load(const std::string& text, ReducedUse reduced = ReducedUse::trained) const {
    SceneOptions options;
    options.mesher = SOFT_ROBOT_LAB_MESHER;
    options.cache_folder = path("cache");
    options.actuator_factory = make_actuator;
    options.reduced = reduced;
    return load_scene(write("scene.yaml", "include: coarse.yaml\n" + text), options);
  }
};

}  // namespace soft_robot_lab
