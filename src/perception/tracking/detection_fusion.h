// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "marker_detection.h"

namespace soft_robot_lab {

// A marker's place as several cameras see it.
struct FusedSights {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();        // world
  Eigen::Matrix3d information_root = Eigen::Matrix3d::Zero();  // square root of the inverse covariance; may lack rank
  double misfit = 0;                                           // sum of squared residuals over their deviations
  int cameras = 0;
};

// What is believed of a marker before it is looked for.
struct MarkerPrediction {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Identity();
  int colour = -1;  // -1: any
};

// Least squares of pixel and depth residuals by Gauss and Newton's method from the predicted position; sights at other
// times are compared with where the marker is then. What the sights do not fix stays as predicted. Nothing where it
// does not converge in front of all cameras.
std::optional<FusedSights> fuse(const std::vector<MarkerDetection>& sights, const MarkerPrediction& predicted);

// The squared Mahalanobis distance of what was measured from what was predicted.
double surprise(const FusedSights& fused, const MarkerPrediction& predicted);

// As fuse, but where the sights contradict each other or the prediction, all that is left without one depth or one
// camera and is within the gate, what agrees best first. What agrees best may fix less than a point, as one camera
// without depth does.
std::vector<FusedSights> fuse_what_agrees(const std::vector<MarkerDetection>& sights, const MarkerPrediction& predicted,
                                          double gate);

}  // namespace soft_robot_lab
