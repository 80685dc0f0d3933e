// SPDX-License-Identifier: BSD-3-Clause
// A camera's images with the simulated robot over them, close up, as a session sends both.
#pragma once

#include <optional>
#include <string>

#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <soft_robot_lab/RealityGap.h>
#include <tf2_ros/buffer.h>
#include <visualization_msgs/Marker.h>

#include "ros/base/frame_listener.h"
#include "ros/display/camera_overlay.h"

namespace soft_robot_lab {

class RobotImage {
 public:
  // The camera stands where the tracker has it. Bad messages stand in the log; the next ones go on.
  RobotImage(ros::NodeHandle& node, const std::string& camera);

  void show_gap(const std::optional<RealityGap>& gap) { gap_ = gap; }  // from now on

 private:
  void on_info(const sensor_msgs::CameraInfo& info) { info_ = info; }
  void on_surface(const visualization_msgs::Marker& surface) { surface_ = surface; }
  void on_image(const sensor_msgs::Image& colour);

  std::string optical_frame_;
  CloseUp close_up_;
  std::optional<sensor_msgs::CameraInfo> info_;
  std::optional<visualization_msgs::Marker> surface_;
  std::optional<RealityGap> gap_;
  tf2_ros::Buffer frames_;
  FrameListener listener_{frames_};
  ros::Publisher publisher_;
  ros::Subscriber info_subscriber_, image_subscriber_, surface_subscriber_;
};

}  // namespace soft_robot_lab
