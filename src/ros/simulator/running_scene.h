// SPDX-License-Identifier: BSD-3-Clause
// A scene that a session runs, with all that goes where it goes.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robot/scene/scene_motion.h"
#include "ros/display/surface_marker.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

struct RunningScene {
  // `skin_opacity` in [0, 1]; 0: fitting_opacity.
  RunningScene(Scene loaded, double skin_opacity);

  // What was asked for, newton, xpbd or reduced: a reduced model that is not trained yet, or was left, counts.
  std::string solver() const;

  std::string path;
  std::vector<SolveWarning> warnings;
  std::optional<FidelityReport> fidelity;
  bool untrained;  // its reduced model is to be trained
  std::unique_ptr<Simulation> simulation;
  SceneMotion motion;  // of the simulation, by a reduced model where there is one
  SurfaceMarker surface;
  SceneMotion::Place start;  // what a reset brings back
};

// Logs what the file's readers warn of, each warning once. Throws what load_scene throws.
std::unique_ptr<RunningScene> load_running_scene(const std::string& path, SceneOptions options, double skin_opacity);

}  // namespace soft_robot_lab
