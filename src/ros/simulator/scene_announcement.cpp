// SPDX-License-Identifier: BSD-3-Clause
#include "scene_announcement.h"

#include <stdexcept>
#include <vector>

#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "ros/messages/image_messages.h"

namespace soft_robot_lab {

namespace {

std_msgs::String text_message(const std::string& text) {
  std_msgs::String message;
  message.data = text;
  return message;
}

}  // namespace

void SceneAnnouncement::announce_frames(const Eigen::Vector3d& position_m) {
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  std::vector<geometry_msgs::TransformStamped> frames = {transform_message(world_frame(), robot_frame(), here)};
  if (world_frame() != room_frame) {
    frames.push_back(transform_message(room_frame, world_frame(), Eigen::Translation3d(position_m) * here));
  } else if (!position_m.isZero(0.0)) {
    throw std::invalid_argument("position_m: must be zero in a session that has no namespace");
  }
  frames_.sendTransform(frames);
}

void SceneAnnouncement::announce(const std::string& path, const ActuatorRanges& ranges) {
  scene_path_.publish(text_message(path));
  ranges_.publish(ranges);
}

void SceneAnnouncement::announce_solver(const std::string& solver) { solver_.publish(text_message(solver)); }

}  // namespace soft_robot_lab
