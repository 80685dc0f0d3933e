// SPDX-License-Identifier: BSD-3-Clause
// What a camera sees, with the simulated robot drawn over it.
#pragma once

#include <optional>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <soft_robot_lab/RealityGap.h>
#include <visualization_msgs/Marker.h>

#include "soft_robot_lab/perception/tracking/camera_model.h"

namespace soft_robot_lab {

// A copy of the colour image (rgb), tinted where the surface's triangles (robot_base) are seen, with their outline.
// Triangles behind the camera are left out. With a gap also lines from simulated to measured markers, and their rms.
cv::Mat draw_robot(const cv::Mat& colour, const CameraModel& model, const Eigen::Isometry3d& camera_from_robot,
                   const visualization_msgs::Marker& surface, const std::optional<RealityGap>& gap);

// The part of a camera's images around the robot. It stays where it is as long as the robot is well inside.
class CloseUp {
 public:
  struct View {
    cv::Mat image;      // as large as the one it is cut from
    CameraModel model;  // of the camera that would have taken it
  };
  // All of the image where the robot is not in it.
  View of(const cv::Mat& image, const CameraModel& model, const Eigen::Isometry3d& camera_from_robot,
          const visualization_msgs::Marker& surface);

 private:
  Eigen::AlignedBox2d window_px_;
};

}  // namespace soft_robot_lab
