// SPDX-License-Identifier: BSD-3-Clause
#include "perception/render/exact_camera.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "seen_things.h"

namespace soft_robot_lab {
namespace {

// Where what is darker than white has its centre.
Eigen::Vector2d centre_of_darkness(const cv::Mat& colour) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int v = 0; v < colour.rows; ++v)
    for (int u = 0; u < colour.cols; ++u) sum += (1 - colour.at<cv::Vec3f>(v, u)[1]) * Eigen::Vector3d(u, v, 1);
  return sum.head<2>() / sum.z();
}

TEST(ExactCamera, MeasuresATiltedPlane) {
  Seen seen;
  add_rectangle(seen, {-1, -0.3, -1}, {2, 0, 0}, {0, 0.9, 2});  // y = -0.3 + 0.45 (z + 1)
  const RayScene scene = seen.scene();
  const ExactCamera camera(small_camera(), facing_pose(0.6), scene);
  const ExactImage image = exact_picture(camera, scene);
  for (int v = 0; v < image.depth.rows; v += 7)
    for (int u = 0; u < image.depth.cols; u += 7) {
      const Eigen::Vector3d ray = camera.model().ray({u, v});  // z_world = -ray.y * depth, y_world = depth - 0.6
      const double depth_m = (0.6 - 0.3 + 0.45) / (1 + 0.45 * ray.y());
      EXPECT_NEAR(image.depth.at<float>(v, u), depth_m, 2e-6);
    }
}

TEST(ExactCamera, MeasuresABallThroughABentLens) {
  Seen seen;
  seen.surroundings.balls.push_back({{0.02, 0.05, -0.01}, 0.04, {1, 1, 1}});
  const RayScene scene = seen.scene();
  CameraModel model = small_camera();
  model.distortion = {0.12, -0.25, 0.001, -0.002, 0.08};
  const ExactCamera camera(model, facing_pose(0.6), scene);
  int met = 0;
  for (int v = 0; v < model.height_px; ++v)
    for (int u = 0; u < model.width_px; ++u) {
      const Eigen::Vector3d ray = model.ray({u, v}), centre(0.02, 0.01, 0.65);
      const double a = ray.squaredNorm(), b = ray.dot(centre), c = centre.squaredNorm() - 0.04 * 0.04;
      if (std::abs(b * b - a * c) < 1e-5) continue;  // grazing
      const double depth_m = b * b > a * c ? (b - std::sqrt(b * b - a * c)) / a : 0;
      ASSERT_NEAR(camera.background().depth.at<float>(v, u), depth_m, 5e-6) << u << ", " << v;
      met += depth_m > 0;
    }
  EXPECT_GT(met, 3000);
}

TEST(ExactCamera, DrawsFacingStickersAboutTheirProjection) {
  CameraModel model = small_camera();
  model.distortion = {0.12, -0.25, 0.001, -0.002, 0.08};
  for (int i = 0; i < 40; ++i) {
    Seen seen = facing_wall();
    const Eigen::Vector3d position_m(0.0021 * i - 0.05, 0, 0.0013 * i - 0.03);
    add_sticker(seen, position_m);
    const RayScene scene = seen.scene();
    const ExactCamera camera(model, facing_pose(0.6), scene);
    const Eigen::Vector2d centre = centre_of_darkness(exact_picture(camera, scene).colour);
    const Eigen::Vector2d expected = model.project(camera.world_from_camera().inverse() * position_m);
    EXPECT_LT((centre - expected).norm(), 0.03) << i;
  }
}

TEST(ExactCamera, PaintsAsMuchAsTheStickerIsLarge) {
  Seen seen = facing_wall();
  add_sticker(seen, {0.0123, 0, 0.0071}, 0.010);
  const RayScene scene = seen.scene();
  const ExactCamera camera(small_camera(), facing_pose(0.6), scene);
  const cv::Mat dark = 1 - cv::Mat(exact_picture(camera, scene).colour.reshape(1));
  const double radius_px = 0.005 / 0.6 * camera.model().focal_x_px;
  EXPECT_NEAR(cv::sum(dark)[0] / 3 / (M_PI * radius_px * radius_px), 1, 0.01);
}

TEST(ExactCamera, DrawsAMarkerFarFromTheSkinAsABall) {
  Seen seen = facing_wall();
  add_sticker(seen, {0, -0.02, 0});
  const RayScene scene = seen.scene();
  CameraModel model = small_camera();
  model.centre_x_px = 105, model.centre_y_px = 59;
  const ExactCamera camera(model, facing_pose(0.6), scene);
  EXPECT_NEAR(exact_picture(camera, scene).depth.at<float>(59, 105), 0.58 - 0.003, 2e-6);
}

TEST(ExactCamera, PaintsNoStickerRoundASharpEdge) {
  Seen seen = facing_wall(0.04, 0.005);
  add_rectangle(seen, {-0.02, 0, -0.0025}, {0, 0.02, 0}, {0.04, 0, 0});  // lower side, which faces down
  add_sticker(seen, {0, 0, 0});
  const RayScene scene = seen.scene();
  const ExactCamera camera(small_camera(), look_at({0, -0.4, -0.4}, {0, 0, 0}), scene);
  const Eigen::Vector3d beneath = camera.world_from_camera().inverse() * Eigen::Vector3d(0, 0.001, -0.0025);
  const Eigen::Vector2d pixel = camera.model().project(beneath);
  const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
  EXPECT_GT(exact_picture(camera, scene).colour.at<cv::Vec3f>(v, u)[1], 0.8f);
}

TEST(ExactCamera, TellsWhichPartOfAStickerIsSeen) {
  Seen seen = facing_wall();
  for (double x_m : {-0.05, 0.0, 0.05}) add_sticker(seen, {x_m, 0, 0});
  add_rectangle(seen, {-0.1, -0.01, -0.1}, {0.1, 0, 0}, {0, 0, 0.2});  // hides x < 0, and half of the second sticker
  const RayScene scene = seen.scene();
  const Eigen::Vector3d camera_m(0, -0.6, 0);
  EXPECT_FALSE(scene.sight(0, camera_m).centre_seen);
  EXPECT_EQ(scene.sight(0, camera_m).share_seen, 0);
  EXPECT_NEAR(scene.sight(1, camera_m).share_seen, 0.5, 0.05);
  EXPECT_TRUE(scene.sight(2, camera_m).centre_seen);
  EXPECT_EQ(scene.sight(2, camera_m).share_seen, 1);
  EXPECT_FALSE(scene.sight(2, {0, 0.6, 0}).centre_seen);  // from behind
}

TEST(ExactCamera, FollowsTheSkin) {
  Seen seen = facing_wall();
  add_sticker(seen, {0, 0, 0});
  RayScene scene = seen.scene();
  SeenState moved = seen.state;
  moved.vertices_m.row(1).array() += 0.1;
  moved.stickers_m.row(1).array() += 0.1;
  scene.show(moved);
  const ExactCamera camera(small_camera(), facing_pose(0.6), scene);
  EXPECT_NEAR(exact_picture(camera, scene).depth.at<float>(10, 10), 0.7, 2e-6);
}

TEST(RayScene, RefusesWhatCannotBeSeen) {
  Seen seen = facing_wall();
  add_sticker(seen, {0, 0, 0});
  RayScene scene = seen.scene();
  SeenState wrong = seen.state;
  wrong.vertices_m(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(scene.show(wrong), std::invalid_argument);
  wrong = seen.state;
  wrong.vertices_m.conservativeResize(3, 3);
  EXPECT_THROW(scene.show(wrong), std::invalid_argument);
  wrong = seen.state;
  wrong.stickers_m.resize(3, 0);
  EXPECT_THROW(scene.show(wrong), std::invalid_argument);
  Seen broken = seen;
  broken.robot.triangles(0, 0) = 4;
  EXPECT_THROW(broken.scene(), std::invalid_argument);
  broken = seen;
  broken.robot.stickers[0].diameter_m = 0;
  EXPECT_THROW(broken.scene(), std::invalid_argument);
  broken = seen;
  broken.surroundings.balls.push_back({{0, 0, 0}, -1, {1, 1, 1}});
  EXPECT_THROW(broken.scene(), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
