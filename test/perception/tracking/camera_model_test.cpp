// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/perception/tracking/camera_model.h"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

CameraModel bent_camera() {
  CameraModel camera = d415_camera(848, 480);
  camera.distortion = {0.12, -0.25, 0.001, -0.002, 0.08};
  return camera;
}

// As Azure Kinect's and others' drivers send it.
CameraModel rational_camera() {
  CameraModel camera = d415_camera(848, 480);
  camera.distortion = {0.5, -2.6, 0.0004, -0.0001, 1.5, 0.38, -2.4, 1.4};
  return camera;
}

TEST(CameraModel, RayUndoesProjectionThroughTheLens) {
  for (const CameraModel& camera : {bent_camera(), rational_camera()})
    for (double u : {0.0, 200.5, 423.5, 847.0})
      for (double v : {0.0, 100.25, 479.0}) {
        const Eigen::Vector3d point = 0.6 * camera.ray({u, v});
        EXPECT_NEAR((camera.project(point) - Eigen::Vector2d(u, v)).norm(), 0, 1e-8);
        EXPECT_DOUBLE_EQ(point.z(), 0.6);
      }
}

TEST(CameraModel, DividesWhereItsLensIsRational) {
  const Eigen::Vector2d seen = rational_camera().project({0.13, -0.08, 0.57});
  EXPECT_NEAR(seen.x(), 564.1758104201097, 1e-9);  // by OpenCV's formula
  EXPECT_NEAR(seen.y(), 152.94513341703828, 1e-9);
}

TEST(CameraModel, GradientAgreesWithDifferences) {
  for (const CameraModel& camera : {bent_camera(), rational_camera()}) {
    const Eigen::Vector3d point(0.13, -0.08, 0.57);
    const auto gradient = camera.project_gradient(point);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d step = 1e-6 * Eigen::Vector3d::Unit(axis);
      const Eigen::Vector2d difference = (camera.project(point + step) - camera.project(point - step)) / 2e-6;
      EXPECT_NEAR((gradient.col(axis) - difference).norm(), 0, 1e-5 * gradient.norm());
    }
  }
}

TEST(CameraModel, SaysWhereItsLensFolds) {
  CameraModel camera = d415_camera(848, 480);
  camera.distortion = {-2.0, 0, 0, 0, 0};
  EXPECT_THROW(camera.ray({847, 0}), std::domain_error);
}

TEST(CameraModel, RefusesWhatIsNoCamera) {
  EXPECT_THROW(d415_camera(848, 300), std::invalid_argument);
  EXPECT_THROW(d415_camera(0, 0), std::invalid_argument);
  CameraModel camera = d415_camera(1280, 720);
  EXPECT_NO_THROW(camera.validate());
  camera.focal_x_px = 0;
  EXPECT_THROW(camera.validate(), std::invalid_argument);
  camera = d415_camera(1280, 720);
  camera.distortion[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(camera.validate(), std::invalid_argument);
}

TEST(CameraModel, SeesOnlyItsImage) {
  const CameraModel camera = d415_camera(848, 480);
  EXPECT_TRUE(camera.sees({0, 0}));
  EXPECT_TRUE(camera.sees({847.4, 479.4}));
  EXPECT_FALSE(camera.sees({847.6, 100}));
  EXPECT_FALSE(camera.sees({100, -0.6}));
}

}  // namespace
}  // namespace soft_robot_lab
