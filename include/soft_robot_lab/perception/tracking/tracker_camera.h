// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <Eigen/Geometry>

#include "camera_model.h"

namespace soft_robot_lab {

// A camera as the tracker knows it.
struct TrackerCamera {
  std::string name;  // as in RgbdFrame
  CameraModel model;
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();  // of the optical frame
};

}  // namespace soft_robot_lab
