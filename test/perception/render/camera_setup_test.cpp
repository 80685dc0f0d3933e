// SPDX-License-Identifier: BSD-3-Clause
#include "perception/render/camera_setup.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "perception/calibration/calibration.h"

namespace soft_robot_lab {
namespace {

constexpr char good_camera[] =
    "  - {name: left, width_px: 848, height_px: 480, position_m: [0, -0.4, 0.01], look_at_m: [0, 0, 0]}\n";

CameraSetup read(const std::string& text) {
  const std::string path = testing::TempDir() + "rig.yaml";
  std::ofstream(path) << text;
  return read_camera_setup(path);
}

TEST(CameraSetup, ReadsEveryFileOfTheFolder) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SOFT_ROBOT_LAB_SOURCE "/config/cameras")) {
    SCOPED_TRACE(entry.path());
    if (entry.path().filename() == "box_poses.yaml") continue;  // where a tracker believes them
    EXPECT_FALSE(read_camera_setup(entry.path()).cameras.empty());
    ++count;
  }
  EXPECT_GE(count, 1);
}

TEST(CameraSetup, StandsAtSixtyCentimetresInTheDefaultBox) {
  const CameraSetup rig = read_camera_setup(SOFT_ROBOT_LAB_SOURCE "/config/cameras/box.yaml");
  ASSERT_EQ(rig.cameras.size(), 2u);
  for (const RigCamera& camera : rig.cameras)
    EXPECT_NEAR((camera.pose.world_from_camera.translation() - Eigen::Vector3d(0, 0, -0.05)).norm(), 0.6, 0.01);
}

TEST(CameraSetup, StandsWhereTheTrackerBelievesIt) {
  const CameraSetup rig = read_camera_setup(SOFT_ROBOT_LAB_SOURCE "/config/cameras/box.yaml");
  const auto believed = read_camera_poses(SOFT_ROBOT_LAB_SOURCE "/config/cameras/box_poses.yaml");
  ASSERT_EQ(believed.size(), rig.cameras.size());
  for (std::size_t i = 0; i < believed.size(); ++i) {
    EXPECT_EQ(believed[i].name, rig.cameras[i].pose.name);
    EXPECT_TRUE(believed[i].world_from_camera.isApprox(rig.cameras[i].pose.world_from_camera, 1e-12));
  }
}

TEST(CameraSetup, HangsTheBallsWhereTheCalibrationExpectsThem) {
  const CameraSetup rig = read_camera_setup(SOFT_ROBOT_LAB_SOURCE "/config/cameras/box.yaml");
  const BallPlacement placement = read_ball_placement(SOFT_ROBOT_LAB_SOURCE "/config/robots/spinebot/balls.yaml");
  ASSERT_EQ(rig.calibration_balls.size(), placement.balls.size());
  for (std::size_t i = 0; i < placement.balls.size(); ++i) {
    EXPECT_EQ(rig.calibration_balls[i].center_m, placement.balls[i].position_m);
    EXPECT_EQ(rig.calibration_balls[i].radius_m, placement.radius_m);
  }
}

TEST(CameraSetup, ReadsItsKeys) {
  const CameraSetup rig =
      read(std::string("cameras:\n") + good_camera +
           "  - {name: b, width_px: 1280, height_px: 720, rate_hz: 15, position_m: [0, 0.4, 0], "
           "quaternion_xyzw: [0, 0, 0, 1], distortion: [0.1, 0, 0, 0, 0], sensor: {base: d415, gloss: 0}}\n"
           "markers: {diameter_m: 0.005, overrides: {tip: {colour: [1, 0, 0]}}}\n"
           "balls: [{center_m: [0, 0, 0.1]}]\n"
           "calibration_balls: [{center_m: [0.1, 0, 0]}, {center_m: [0, 0.1, 0], radius_m: 0.01}]\n"
           "lighting: {shaded: false}\n");
  EXPECT_EQ(rig.cameras[1].model.width_px, 1280);
  EXPECT_EQ(rig.cameras[1].model.distortion[0], 0.1);
  EXPECT_EQ(rig.cameras[1].rate_hz, 15);
  EXPECT_EQ(rig.cameras[1].sensor.gloss, 0);
  EXPECT_EQ(rig.cameras[1].sensor.baseline_m, 0.055);
  EXPECT_GT(rig.cameras[1].sensor.disparity_noise_px, 0);
  EXPECT_EQ(rig.cameras[0].sensor.disparity_noise_px, 0);
  EXPECT_EQ(rig.surroundings.balls.size(), 1u);
  ASSERT_EQ(rig.calibration_balls.size(), 2u);
  EXPECT_EQ(rig.calibration_balls[1].radius_m, 0.01);
  EXPECT_FALSE(rig.surroundings.lighting.shaded);
  const auto stickers = rig.stickers({"base", "tip"});
  EXPECT_EQ(stickers[0].colour, Sticker{}.colour);
  EXPECT_EQ(stickers[1].colour, Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(stickers[1].diameter_m, 0.005);
}

TEST(CameraSetup, RefusesWhatItDoesNotUnderstand) {
  const std::string good = std::string("cameras:\n") + good_camera;
  EXPECT_NO_THROW(read(good));
  for (const std::string& wrong : {
           std::string("cameras: []\n"),
           good + good_camera,  // two of one name
           good + "colour: [0, 0, 0]\n",
           good + "markers: {size_m: 0.006}\n",
           good + "markers: {diameter_m: -0.006}\n",
           good + "robot_colour: [0, 0, 2]\n",
           good + "box: {size_m: [0.7, 0.7, 0.7], center_m: [0, 0, 0], colour: [0, 0, 300]}\n",
           good + "box: {size_m: [0.7, 0, 0.7], center_m: [0, 0, 0]}\n",
           good + "box: {size_m: [0.7, 0.7, 0.7], center_m: [0, 0, 0]}\n",  // the camera is outside
           good + "lighting: {lights: [{position_m: [0, 0, 1]}]}\n",
           std::string("cameras:\n  - {name: a, width_px: 848, height_px: 480, position_m: [0, -0.4, 0]}\n"),
           std::string("cameras:\n  - {name: a, width_px: 640, height_px: 480, position_m: [0, -1, 0], look_at_m: [0, "
                       "0, 0]}\n"),
           std::string(
               "cameras:\n  - {name: a, width_px: 848, height_px: 480, position_m: [0, 0, 1], look_at_m: [0, 0, 0]}\n"),
           std::string(
               "cameras:\n  - {name: a, width_px: 848, height_px: 480, position_m: [0, -1, 0], look_at_m: [0, 0, 0], "
               "sensor: d435}\n"),
           std::string(
               "cameras:\n  - {name: a, width_px: 848, height_px: 480, position_m: [0, -1, 0], look_at_m: [0, 0, 0], "
               "sensor: {blur_px: -1}}\n"),
           std::string(
               "cameras:\n  - {name: a, width_px: 848, height_px: 480, position_m: [0, -1, 0], look_at_m: [0, 0, 0], "
               "sensor: {blurr_px: 1}}\n"),
       })
    EXPECT_THROW(read(wrong), SettingsError) << wrong;
}

TEST(SensorModel, RefusesNonsense) {
  SensorModel sensor = SensorModel::d415();
  EXPECT_NO_THROW(sensor.validate());
  sensor.baseline_m = 0;
  EXPECT_THROW(sensor.validate(), std::invalid_argument);
}

TEST(SensorModel, NamesKeyValueAndRangeOfARefusedDepthStep) {
  EXPECT_EQ(read_sensor_model(YamlNode::parse("{depth_step_m: 0}", "sensor")).depth_step_m, 0);
  for (const std::string value : {"-0.001", "0.2"}) {
    try {
      read_sensor_model(YamlNode::parse("{depth_step_m: " + value + "}", "sensor"));
      FAIL() << value;
    } catch (const SettingsError& error) {
      for (const std::string& part : {std::string("depth_step_m"), value, std::string("[0, 0.1]")})
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace soft_robot_lab
