// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "check_casting.h"
#include "soft_robot_lab/robot/design/mesher.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

struct CastRobotFile {
  CastRobot robot;
  CastingSettings settings;
  std::string solid_yaml;  // empty: its body is a mesh
  MesherOptions mesher;    // that made the surface
};

// Reads a robot's file as a scene, with its strict keys, and the surface of its body: its solid's, or its mesh's where
// it has no solid. Throws as load_scene does.
CastRobotFile load_cast_robot(const std::string& path, const SceneOptions& options);

}  // namespace soft_robot_lab
