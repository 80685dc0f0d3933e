// SPDX-License-Identifier: BSD-3-Clause
#include "perception/calibration/camera_pose.h"

#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

std::string write(const std::string& text) {
  const std::string path = testing::TempDir() + "poses.yaml";
  std::ofstream(path) << text;
  return path;
}

TEST(CameraPose, LooksAtItsTargetUpright) {
  const Eigen::Vector3d position_m(0.2, -0.5, -0.3), target_m(0, 0, -0.05);
  const Eigen::Isometry3d world_from_camera = look_at(position_m, target_m);
  const Eigen::Vector3d target_in_camera = world_from_camera.inverse() * target_m;
  EXPECT_NEAR(target_in_camera.head<2>().norm(), 0, 1e-12);
  EXPECT_NEAR(target_in_camera.z(), (target_m - position_m).norm(), 1e-12);
  EXPECT_NEAR(world_from_camera.linear().determinant(), 1, 1e-12);
  EXPECT_NEAR(world_from_camera.linear()(2, 0), 0, 1e-12);  // its x is level
  EXPECT_LT(world_from_camera.linear()(2, 1), 0);           // its y points down
}

TEST(CameraPose, SurvivesItsFile) {
  CameraPose left, right;
  left.name = "camera_left";
  left.world_from_camera = look_at({0.2, -0.5, -0.3}, {0, 0, -0.05});
  left.residual_m = 0.00021;
  right.name = "camera_right";
  right.world_from_camera = look_at({-0.1, -0.5, 0.3}, {0, 0, -0.05});
  const std::string path = testing::TempDir() + "a_new_folder/written_poses.yaml";
  write_camera_poses(path, {left, right});
  const std::vector<CameraPose> poses = read_camera_poses(path);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0].name, "camera_left");
  EXPECT_TRUE(poses[0].world_from_camera.isApprox(left.world_from_camera, 1e-14));
  EXPECT_EQ(poses[0].residual_m, 0.00021);
  EXPECT_TRUE(poses[1].world_from_camera.isApprox(right.world_from_camera, 1e-14));
  EXPECT_FALSE(poses[1].residual_m);
}

TEST(CameraPose, KeepsNamesOfAnyCharacters) {
  std::vector<CameraPose> poses(5);
  const std::vector<std::string> names = {"a: b", "- #1", "\"it's\" {x}", "[camera", "line\nend"};
  for (std::size_t i = 0; i < names.size(); ++i) poses[i].name = names[i];
  const std::string path = testing::TempDir() + "named_poses.yaml";
  write_camera_poses(path, poses);
  const std::vector<CameraPose> read = read_camera_poses(path);
  ASSERT_EQ(read.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(read[i].name, names[i]);
}

TEST(CameraPose, RefusesAWrongFile) {
  const std::string start = "cameras:\n  - {name: a, position_m: [0, 0, 0], ";
  EXPECT_NO_THROW(read_camera_poses(write(start + "quaternion_xyzw: [0, 0, 0, 1]}\n")));
  EXPECT_THROW(read_camera_poses(write(start + "quaternion_xyzw: [0, 0, 0, 2]}\n")), SettingsError);
  EXPECT_THROW(read_camera_poses(write(start + "quaternion_xyzw: [0, 0, 1]}\n")), SettingsError);
  EXPECT_THROW(read_camera_poses(write(start + "look_at_m: [0, 0, 1]}\n")), SettingsError);  // straight up
  EXPECT_THROW(read_camera_poses(write(start + "residual_m: 0}\n")), SettingsError);
  EXPECT_THROW(read_camera_poses(write(start + "quaternion_xyzw: [0, 0, 0, 1], look_at_m: [0, 1, 0]}\n")),
               SettingsError);
  EXPECT_THROW(read_camera_poses(write(start + "quaternion_xyzw: [0, 0, 0, 1], residual_m: -1}\n")), SettingsError);
  EXPECT_THROW(read_camera_poses(write(start + "quaternion_xyzw: [0, 0, 0, 1], roll: 1}\n")), SettingsError);
  EXPECT_THROW(write_camera_poses("/dev/null/no_folder/poses.yaml", {}), std::runtime_error);
}

}  // namespace
}  // namespace soft_robot_lab
