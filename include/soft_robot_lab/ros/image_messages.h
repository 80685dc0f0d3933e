// Frames of RGB-D cameras as realsense2_camera publishes them.
#pragma once

#include <string>

#include <Eigen/Geometry>
#include <geometry_msgs/TransformStamped.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include "soft_robot_lab/vision/camera_model.h"
#include "soft_robot_lab/vision/rgbd_frame.h"

namespace soft_robot_lab {

struct FrameMessages {
  sensor_msgs::Image colour;     // rgb8
  sensor_msgs::Image depth;      // 16UC1 [mm]
  sensor_msgs::CameraInfo info;  // of both
};

std::string optical_frame(const std::string& camera);
FrameMessages frame_messages(const RgbdFrame& frame, const CameraModel& model, const ros::Time& stamp);
geometry_msgs::TransformStamped transform_message(const std::string& parent, const std::string& child,
                                                  const Eigen::Isometry3d& parent_from_child);

}  // namespace soft_robot_lab
