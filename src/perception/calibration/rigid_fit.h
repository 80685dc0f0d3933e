// SPDX-License-Identifier: BSD-3-Clause
// The rigid motion between two measurements of the same points.
#pragma once

#include <vector>

#include <Eigen/Geometry>

namespace soft_robot_lab {

// One point as two frames have it.
struct PointPair {
  Eigen::Vector3d first_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d second_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d first_covariance_m2 = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d second_covariance_m2 = Eigen::Matrix3d::Zero();
};

struct RigidFit {
  Eigen::Isometry3d first_from_second = Eigen::Isometry3d::Identity();
  // Of a small turn [rad] about the first frame's axes through the points' middle, and of the middle [m].
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  double residual_m = 0;  // root mean square distance of the points
};

// Kabsch's solution (never a mirror image), then the most likely one by Gauss-Newton with the points' covariances.
// Where a pair has none in either frame, a point counts as measured within a millimetre. Throws std::invalid_argument:
// fewer than three points, numbers that are not finite, points within 5 mm of one line.
RigidFit fit_rigid(const std::vector<PointPair>& pairs);

}  // namespace soft_robot_lab
