// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/perception/tracking/camera_model.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

namespace soft_robot_lab {
namespace {

// The lens at a point (x, y) of the plane z = 1, and its derivative.
struct Lens {
  Eigen::Vector2d point;
  Eigen::Matrix2d gradient;
};

Lens distort(const std::array<double, 8>& coefficients, const Eigen::Vector2d& ideal) {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = coefficients;
  const double x = ideal.x(), y = ideal.y(), r2 = ideal.squaredNorm();
  const double above = 1 + r2 * (k1 + r2 * (k2 + r2 * k3)), below = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double above_slope = k1 + r2 * (2 * k2 + r2 * 3 * k3), below_slope = k4 + r2 * (2 * k5 + r2 * 3 * k6);
  const double radial = above / below;
  const double slope = 2 * (above_slope - radial * below_slope) / below;  // d radial / d ideal = slope * ideal
  Lens lens;
  lens.point =
      radial * ideal + Eigen::Vector2d(2 * p1 * x * y + p2 * (r2 + 2 * x * x), p1 * (r2 + 2 * y * y) + 2 * p2 * x * y);
  lens.gradient = radial * Eigen::Matrix2d::Identity() + slope * ideal * ideal.transpose();
  lens.gradient(0, 0) += 2 * p1 * y + 6 * p2 * x;
  lens.gradient(0, 1) += 2 * p1 * x + 2 * p2 * y;
  lens.gradient(1, 0) += 2 * p1 * x + 2 * p2 * y;
  lens.gradient(1, 1) += 6 * p1 * y + 2 * p2 * x;
  return lens;
}

void require_positive(const char* field, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw std::invalid_argument(std::string(field) + " is " + std::to_string(value) + "; allowed: a finite number > 0");
}

}  // namespace

void CameraModel::validate() const {
  require_positive("width_px", width_px);
  require_positive("height_px", height_px);
  require_positive("focal_x_px", focal_x_px);
  require_positive("focal_y_px", focal_y_px);
  for (double value : {centre_x_px, centre_y_px})
    if (!std::isfinite(value)) throw std::invalid_argument("the image's centre is not finite; allowed: pixels");
  for (double value : distortion)
    if (!std::isfinite(value))
      throw std::invalid_argument("distortion is not finite; allowed: k1, k2, p1, p2, k3, k4, k5, k6");
}

Eigen::Vector2d CameraModel::project(const Eigen::Vector3d& point_in_camera) const {
  const Eigen::Vector2d seen = distort(distortion, point_in_camera.head<2>() / point_in_camera.z()).point;
  return {focal_x_px * seen.x() + centre_x_px, focal_y_px * seen.y() + centre_y_px};
}

Eigen::Matrix<double, 2, 3> CameraModel::project_gradient(const Eigen::Vector3d& point_in_camera) const {
  const double depth = point_in_camera.z();
  const Eigen::Vector2d ideal = point_in_camera.head<2>() / depth;
  Eigen::Matrix<double, 2, 3> perspective;
  perspective << 1 / depth, 0, -ideal.x() / depth, 0, 1 / depth, -ideal.y() / depth;
  return Eigen::Vector2d(focal_x_px, focal_y_px).asDiagonal() * distort(distortion, ideal).gradient * perspective;
}

Eigen::Vector3d CameraModel::ray(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d seen((pixel.x() - centre_x_px) / focal_x_px, (pixel.y() - centre_y_px) / focal_y_px);
  Eigen::Vector2d ideal = seen;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Lens lens = distort(distortion, ideal);
    const Eigen::Vector2d miss = lens.point - seen;
    // Beyond the fold the lens turns inside out: that is another pixel's ray.
    const bool folded = lens.gradient.determinant() <= 0 || lens.gradient.trace() <= 0;
    if (miss.norm() < 1e-12 && !folded) return {ideal.x(), ideal.y(), 1};
    ideal -= lens.gradient.inverse() * miss;
  }
  throw std::domain_error("pixel (" + std::to_string(pixel.x()) + ", " + std::to_string(pixel.y()) +
                          ") is not seen through this lens; its distortion folds there");
}

bool CameraModel::sees(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < width_px - 0.5 && pixel.y() < height_px - 0.5;
}

CameraModel d415_camera(int width_px, int height_px) {
  if (width_px <= 0 || height_px <= 0 || std::abs(width_px - height_px * 16 / 9) > 8)
    throw std::invalid_argument("a D415's image of " + std::to_string(width_px) + " x " + std::to_string(height_px) +
                                " pixels; allowed: 16:9, as 848 x 480 or 1280 x 720");
  const double half_angle = 0.5 * 69.4 * M_PI / 180;
  CameraModel camera;
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.focal_x_px = camera.focal_y_px = 0.5 * width_px / std::tan(half_angle);
  camera.centre_x_px = 0.5 * (width_px - 1);
  camera.centre_y_px = 0.5 * (height_px - 1);
  return camera;
}

}  // namespace soft_robot_lab
