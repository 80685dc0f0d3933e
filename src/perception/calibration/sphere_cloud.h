// SPDX-License-Identifier: BSD-3-Clause
// Point clouds: clusters, and spheres among their points (PCL).
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// Indices of the columns that hang together by steps of at most `step_m`, at least `min_points` each.
std::vector<std::vector<int>> euclidean_clusters(const Eigen::Matrix3Xd& points_m, double step_m, int min_points);

struct CloudSphere {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  double radius_m = 0;
  std::vector<int> inliers;
};

// By RANSAC; the same points give the same sphere.
std::optional<CloudSphere> find_sphere(const Eigen::Matrix3Xd& points_m, double min_radius_m, double max_radius_m,
                                       double tolerance_m);

}  // namespace soft_robot_lab
