// SPDX-License-Identifier: BSD-3-Clause
#include "ros/display/camera_overlay.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace soft_robot_lab {
namespace {

// A square of 10 x 10 cm at 1 m, and another one as far behind the camera.
visualization_msgs::Marker squares() {
  visualization_msgs::Marker surface;
  for (const double z : {1.0, -1.0})
    for (const auto& [x, y] :
         {std::pair{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}}) {
      surface.points.emplace_back();
      surface.points.back().x = x;
      surface.points.back().y = y;
      surface.points.back().z = z;
    }
  return surface;
}

TEST(CameraOverlay, TintsTheRobotWhereItIsSeenAndNothingElse) {
  const CameraModel model = d415_camera(848, 480);
  const cv::Mat dark(480, 848, CV_8UC3, cv::Scalar(10, 10, 10));
  const cv::Mat drawn = draw_robot(dark, model, Eigen::Isometry3d::Identity(), squares(), std::nullopt);
  EXPECT_EQ(dark.at<cv::Vec3b>(240, 424), cv::Vec3b(10, 10, 10));
  const int half_px = static_cast<int>(0.05 * model.focal_x_px);
  for (const int off_px : {0, half_px - 3}) EXPECT_GT(drawn.at<cv::Vec3b>(240, 424 + off_px)[2], 60) << off_px;
  EXPECT_EQ(drawn.at<cv::Vec3b>(240, 424 + half_px + 5), cv::Vec3b(10, 10, 10));
}

TEST(CameraOverlay, FollowsTheCamerasPlace) {
  const CameraModel model = d415_camera(848, 480);
  const cv::Mat dark(480, 848, CV_8UC3, cv::Scalar(10, 10, 10));
  Eigen::Isometry3d camera_from_robot = Eigen::Isometry3d::Identity();
  camera_from_robot.translation().x() = 0.2;
  const cv::Mat drawn = draw_robot(dark, model, camera_from_robot, squares(), std::nullopt);
  EXPECT_EQ(drawn.at<cv::Vec3b>(240, 424), cv::Vec3b(10, 10, 10));
  EXPECT_GT(drawn.at<cv::Vec3b>(240, 424 + static_cast<int>(0.2 * model.focal_x_px))[2], 60);
}

TEST(CameraOverlay, DrawsALineFromSimulatedToMeasuredMarkers) {
  const CameraModel model = d415_camera(848, 480);
  const cv::Mat dark(480, 848, CV_8UC3, cv::Scalar(10, 10, 10));
  RealityGap gap;
  gap.names = {"tip"};
  gap.measured.resize(1);
  gap.measured[0].x = 0.05;
  gap.measured[0].z = 1.0;
  gap.gaps.resize(1);
  gap.gaps[0].x = 0.05;
  gap.seen = {1};
  const cv::Mat drawn = draw_robot(dark, model, Eigen::Isometry3d::Identity(), {}, gap);
  EXPECT_GT(drawn.at<cv::Vec3b>(240, 424 + static_cast<int>(0.025 * model.focal_x_px))[0], 60);
}

TEST(CameraOverlay, ComesCloseToTheRobotAndStillKnowsWhereItIs) {
  const CameraModel model = d415_camera(848, 480);
  Eigen::Isometry3d camera_from_robot = Eigen::Isometry3d::Identity();
  camera_from_robot.translation() << 0.3, -0.05, 0.0;
  const Eigen::Vector3d corner = camera_from_robot * Eigen::Vector3d(0.05, 0.05, 1.0);
  cv::Mat image(480, 848, CV_8UC3, cv::Scalar(10, 10, 10));
  const Eigen::Vector2d at_px = model.project(corner);
  image(cv::Rect2d(at_px.x() - 1.5, at_px.y() - 1.5, 4.0, 4.0)) = cv::Scalar(255, 255, 255);
  const CloseUp::View view = CloseUp().of(image, model, camera_from_robot, squares());
  EXPECT_EQ(view.image.size(), image.size());
  EXPECT_NO_THROW(view.model.validate());
  const Eigen::Vector2d there_px = view.model.project(corner);
  EXPECT_TRUE(view.model.sees(there_px));
  EXPECT_GT(view.image.at<cv::Vec3b>(std::lround(there_px.y()), std::lround(there_px.x()))[0], 200);
  EXPECT_GT(there_px.y() - view.model.project(camera_from_robot * Eigen::Vector3d(0.0, -0.05, 1.0)).y(), 300.0);
}

TEST(CameraOverlay, FollowsTheRobotOnlyWhereItLeaves) {
  const CameraModel model = d415_camera(848, 480);
  const cv::Mat image(480, 848, CV_8UC3, cv::Scalar(10, 10, 10));
  CloseUp close_up;
  const auto centre_at = [&](double x_m, double z_m) {
    Eigen::Isometry3d camera_from_robot = Eigen::Isometry3d::Identity();
    camera_from_robot.translation() << x_m, 0.0, z_m;
    return close_up.of(image, model, camera_from_robot, squares()).model.centre_x_px;
  };
  const double first_px = centre_at(0.0, 0.0);
  EXPECT_EQ(centre_at(0.01, 0.0), first_px);
  EXPECT_NE(centre_at(0.2, 0.0), first_px);
  const double near_px = centre_at(0.2, -0.4);
  EXPECT_NE(centre_at(0.2, 0.0), near_px) << "too small in the window of a robot that was nearer";
}

TEST(CameraOverlay, TakesImagesOfAnotherSize) {
  CloseUp close_up;
  const Eigen::Isometry3d camera_from_robot(Eigen::Translation3d(0.3, 0.1, 0.0));
  for (const int width_px : {848, 424, 1280}) {
    const CameraModel model = d415_camera(width_px, width_px * 9 / 16);
    const cv::Mat image(model.height_px, model.width_px, CV_8UC3, cv::Scalar(10, 10, 10));
    const CloseUp::View view = close_up.of(image, model, camera_from_robot, squares());
    EXPECT_EQ(view.image.size(), image.size());
    EXPECT_TRUE(view.model.sees(view.model.project(camera_from_robot * Eigen::Vector3d(0.05, 0.05, 1.0)))) << width_px;
  }
  EXPECT_EQ(close_up.of(cv::Mat(20, 30, CV_8UC3), d415_camera(848, 480), camera_from_robot, squares()).image.cols, 30)
      << "smaller than its camera says";
}

TEST(CameraOverlay, ShowsAllOfAnImageThatTheRobotIsNotIn) {
  const CameraModel model = d415_camera(848, 480);
  const cv::Mat image(480, 848, CV_8UC3, cv::Scalar(10, 10, 10));
  Eigen::Isometry3d camera_from_robot = Eigen::Isometry3d::Identity();
  camera_from_robot.translation().x() = 2.0;
  for (const auto& surface : {squares(), visualization_msgs::Marker()})
    EXPECT_EQ(CloseUp().of(image, model, camera_from_robot, surface).model.focal_x_px, model.focal_x_px);
}

}  // namespace
}  // namespace soft_robot_lab
