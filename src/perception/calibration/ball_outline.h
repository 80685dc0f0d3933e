// SPDX-License-Identifier: BSD-3-Clause
// The outline of a ball in a picture. It is a cone of rays about the centre's direction, not a circle about the
// centre's image: an ellipse, and its middle is not where the centre is.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "soft_robot_lab/perception/tracking/camera_model.h"

namespace soft_robot_lab {

constexpr int outline_directions = 96;

// Pixels with sub-pixel places, near the outline of the expected sphere: where brightness is halfway between within and
// without. Fewer than outline_directions where there is no edge, or the image ends.
std::vector<Eigen::Vector2d> find_outline(const cv::Mat& brightness, const CameraModel& camera,
                                          const Eigen::Vector3d& center_m, double radius_m, double min_contrast);

}  // namespace soft_robot_lab
