// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include <Eigen/Core>

namespace soft_robot_lab {

// A pinhole camera with the Brown-Conrady lens of sensor_msgs/CameraInfo ("plumb_bob"), or OpenCV's with a denominator
// ("rational_polynomial"). Frame: x right, y down, z into
// the scene, as ROS's optical frames. Pixel (0, 0) is the middle of the first pixel.
struct CameraModel {
  int width_px = 0;       // > 0
  int height_px = 0;      // > 0
  double focal_x_px = 0;  // > 0
  double focal_y_px = 0;  // > 0
  double centre_x_px = 0;
  double centre_y_px = 0;
  std::array<double, 8> distortion{};  // k1, k2, p1, p2, k3, and k4, k5, k6 of the denominator

  void validate() const;  // throws std::invalid_argument: field, value, allowed range

  // Of a point with z > 0 [m].
  Eigen::Vector2d project(const Eigen::Vector3d& point_in_camera) const;
  // d pixel / d point [px/m].
  Eigen::Matrix<double, 2, 3> project_gradient(const Eigen::Vector3d& point_in_camera) const;
  // The point of depth 1 m that a pixel sees; times a depth (distance along z, not along the ray) it is the point in
  // the camera's frame. Undoes the lens by Newton's method on the distortion; throws std::domain_error where the lens
  // cannot be undone.
  Eigen::Vector3d ray(const Eigen::Vector2d& pixel) const;
  bool sees(const Eigen::Vector2d& pixel) const;  // within the image
};

// An Intel RealSense D415's colour camera: 69.4 degrees across 16:9 (data sheet 337029, table 3-11), no distortion
// after its own rectification. Throws std::invalid_argument unless the width is that of 16:9 within 8 pixels.
CameraModel d415_camera(int width_px, int height_px);

}  // namespace soft_robot_lab
