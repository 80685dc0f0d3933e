// SPDX-License-Identifier: BSD-3-Clause
#include "frames.h"

#include <stdexcept>

#include <ros/this_node.h>

namespace soft_robot_lab {
namespace {

constexpr char robot[] = "robot_base";

}  // namespace

std::string frame_prefix() {
  const std::string& session = ros::this_node::getNamespace();
  const std::size_t first = session.find_first_not_of('/'), last = session.find_last_not_of('/');
  return first == std::string::npos ? "" : session.substr(first, last - first + 1) + "/";
}

std::string world_frame(const std::string& prefix) { return prefix + room_frame; }

std::string robot_frame(const std::string& prefix) { return prefix + robot; }

std::string optical_frame(const std::string& camera, const std::string& prefix) {
  return prefix + camera + "_color_optical_frame";
}

std::string prefix_of_robot(const std::string& frame) {
  const std::size_t end = frame.rfind('/') + 1;  // 0 where there is none
  if (frame.substr(end) != robot)
    throw std::invalid_argument("header.frame_id: '" + frame + "' is not " + robot + ", nor that of a session");
  return frame.substr(0, end);
}

}  // namespace soft_robot_lab
