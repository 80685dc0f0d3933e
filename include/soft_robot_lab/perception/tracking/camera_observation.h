// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <Eigen/Core>

namespace soft_robot_lab {

// A marker as one camera alone has it, in the world by the camera's calibrated pose.
struct CameraObservation {
  std::string camera, marker;
  Eigen::Vector3d measured_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
  // By a simulation or a model of the motion, not by cameras. It may be wrong by much, but alike for all cameras.
  Eigen::Vector3d expected_m = Eigen::Vector3d::Zero();
};

}  // namespace soft_robot_lab
