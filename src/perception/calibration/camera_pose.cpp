// SPDX-License-Identifier: BSD-3-Clause
#include "camera_pose.h"

#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>
#include <stdexcept>

#include "settings/words.h"
#include "settings/write_file.h"

namespace soft_robot_lab {
namespace {

Eigen::Quaterniond read_quaternion(const YamlNode& node) {
  const Eigen::VectorXd numbers = node.as_numbers();
  if (numbers.size() != 4) node.fail("has " + std::to_string(numbers.size()) + " numbers, must have 4: [x, y, z, w]");
  if (std::abs(numbers.norm() - 1) > 1e-3)
    node.fail("has the length " + std::to_string(numbers.norm()) + "; allowed: 1 within 0.001");
  return Eigen::Quaterniond(numbers[3], numbers[0], numbers[1], numbers[2]).normalized();
}

}  // namespace

Eigen::Isometry3d look_at(const Eigen::Vector3d& position_m, const Eigen::Vector3d& target_m) {
  const Eigen::Vector3d ahead = target_m - position_m;
  const Eigen::Vector3d right = ahead.cross(Eigen::Vector3d::UnitZ());
  if (!(right.norm() > 1e-6 * ahead.norm()))
    throw std::invalid_argument(
        "a camera cannot look at where it stands, nor straight up or down; give its quaternion");
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  world_from_camera.translation() = position_m;
  world_from_camera.linear().col(0) = right.normalized();
  world_from_camera.linear().col(1) = ahead.cross(right).normalized();
  world_from_camera.linear().col(2) = ahead.normalized();
  return world_from_camera;
}

Eigen::Isometry3d read_world_from_camera(const YamlNode& node) {
  const Eigen::Vector3d position_m = node.vector3("position_m");
  if (node.has("look_at_m") == node.has("quaternion_xyzw")) node.fail("must have one of look_at_m, quaternion_xyzw");
  if (node.has("quaternion_xyzw"))
    return Eigen::Translation3d(position_m) * read_quaternion(node.child("quaternion_xyzw"));
  try {
    return look_at(position_m, node.vector3("look_at_m"));
  } catch (const SettingsError&) {
    throw;
  } catch (const std::invalid_argument& error) {
    node.child("look_at_m").fail(error.what());
  }
}

std::vector<CameraPose> read_camera_poses(const std::string& path) {
  const YamlNode file = YamlNode::load_file(path);
  std::vector<CameraPose> poses;
  std::set<std::string> names;
  for (const YamlNode& node : file.sequence("cameras")) {
    CameraPose pose;
    pose.name = node.text("name");
    if (!names.insert(pose.name).second) node.child("name").fail("'" + pose.name + "' is there twice");
    pose.world_from_camera = read_world_from_camera(node);
    if (node.has("residual_m")) pose.residual_m = node.number("residual_m", AllowedRange::not_negative());
    poses.push_back(pose);
  }
  file.require_all_read();
  return poses;
}

void write_camera_poses(const std::string& path, const std::vector<CameraPose>& poses) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder);
  std::ostringstream file;
  file.precision(17);
  file << "cameras:\n";
  for (const CameraPose& pose : poses) {
    const Eigen::Vector3d at = pose.world_from_camera.translation();
    const Eigen::Quaterniond turn(pose.world_from_camera.rotation());
    file << "  - name: " << quote(pose.name) << "\n"
         << "    position_m: [" << at.x() << ", " << at.y() << ", " << at.z() << "]\n"
         << "    quaternion_xyzw: [" << turn.x() << ", " << turn.y() << ", " << turn.z() << ", " << turn.w() << "]\n";
    if (pose.residual_m) file << "    residual_m: " << *pose.residual_m << "\n";
  }
  write_file(path, file.str());
}

}  // namespace soft_robot_lab
