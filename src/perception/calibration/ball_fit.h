// SPDX-License-Identifier: BSD-3-Clause
// A sphere fitted to depths and to its outline.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

struct BallMeasurement {
  Eigen::Matrix3Xd points_m;       // on the surface, by depth
  Eigen::Matrix3Xd outline;        // rays to the outline's places
  Eigen::VectorXd depth_sigmas_m;  // along z, one a point; as if their errors were independent
  double outline_sigma = 0;        // of a place [rad]
  double outline_bias_sigma = 0;   // of all of them: the outline looks larger [rad]
};

struct BallFit {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();
  double radius_m = 0;
  double depth_residual_m = 0;  // root mean square
  double outline_residual = 0;  // root mean square [rad]
};

// Starts at the given sphere; its radius is believed within `radius_sigma_m`.
BallFit fit_ball(const BallMeasurement& measured, const Eigen::Vector3d& center_m, double radius_m,
                 double radius_sigma_m);

}  // namespace soft_robot_lab
