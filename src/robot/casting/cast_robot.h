// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "check_casting.h"
#include "shelves.h"
#include "soft_robot_lab/robot/design/mesher.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

struct CastRobotFile {
  CastRobot robot;
  CastingSettings settings;
  std::optional<Solid> solid;       // none: its body is a mesh
  MesherOptions mesher;             // that made the surface
  std::vector<std::string> fibres;  // names of threads: inserts that lie in the mould before it is filled
};

// Reads a robot's file as a scene, with its strict keys, and the surface of its body: its solid's, or its mesh's where
// it has no solid. Its body needs no `fixed`. Throws as load_scene does.
CastRobotFile load_cast_robot(const std::string& path, const SceneOptions& options);

// The same with its bends in use, if anything holds it; they take rest states: 0.1 to 1.5 s CPU. Only what states a
// verdict needs them.
CastRobotFile load_cast_robot_in_use(const std::string& path, const SceneOptions& options);

// load_cast_robot without a mesh for simulations, which takes long where a surface is fine: the body's solid, its
// material, the cables' paths and `casting`. Keys of other blocks are not looked at, but their names are. Throws
// SettingsError.
CastRobotFile load_cast_surface(const std::string& path, const SceneOptions& options);

// Of a robot's file: its folder's where it is called robot.yaml.
std::string robot_name(const std::string& path);

// The surface of a solid, fine enough for the rules; `size_m` is the robot's. Throws as surface_file_for.
Surface surface_of_solid(const Solid& solid, double size_m, const MesherOptions& options);

// What lies on shelves of a robot's mould; nothing where its sheaths have none, or cannot have any.
std::vector<SheathPiece> pieces_on_shelves(const CastRobotFile& file);

// What is said of fibres beside a verdict or a mould, which know nothing of them; empty where there are none.
std::string note_on_fibres(const std::vector<std::string>& fibres);

// The lowest and the highest skin along a direction.
MouldHeights heights_along(const Surface& surface, const Eigen::Vector3d& direction);

// As check_casting of the robot alone; where sheaths lie on shelves, of what these leave of it. Throws as load_scene.
CastingVerdict check_casting(const CastRobotFile& file);

}  // namespace soft_robot_lab
