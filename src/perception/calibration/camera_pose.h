// SPDX-License-Identifier: BSD-3-Clause
// Where a camera stands: in files of calibrations and of rendered rigs alike.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

struct CameraPose {
  std::string name;
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();  // of the optical frame: z ahead, y down
  std::optional<double> residual_m;  // root mean square miss of the calibration that found it
};

// An upright camera at `position_m` whose optical axis meets `target_m`. Throws std::invalid_argument where the two are
// one, or one is straight above the other.
Eigen::Isometry3d look_at(const Eigen::Vector3d& position_m, const Eigen::Vector3d& target_m);

// From the keys position_m and one of look_at_m, quaternion_xyzw (unit length within 1e-3).
Eigen::Isometry3d read_world_from_camera(const YamlNode& node);

//   cameras:
//     - {name: camera_left, position_m: [x, y, z], quaternion_xyzw: [x, y, z, w], residual_m: 0.0002}
// Throws SettingsError; names must be unlike. Residuals are optional.
std::vector<CameraPose> read_camera_poses(const std::string& path);
// Numbers are written so that reading gives the same ones; a folder is made where there is none. Throws
// std::runtime_error where the file cannot be written.
void write_camera_poses(const std::string& path, const std::vector<CameraPose>& poses);

}  // namespace soft_robot_lab
