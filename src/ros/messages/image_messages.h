// SPDX-License-Identifier: BSD-3-Clause
// Frames of RGB-D cameras as realsense2_camera publishes them.
#pragma once

#include <string>

#include <Eigen/Geometry>
#include <geometry_msgs/TransformStamped.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include "soft_robot_lab/perception/tracking/camera_model.h"
#include "soft_robot_lab/perception/tracking/rgbd_frame.h"

namespace soft_robot_lab {

struct FrameMessages {
  sensor_msgs::Image colour;     // rgb8
  sensor_msgs::Image depth;      // 16UC1 [mm] where the frame's depths are whole millimetres, else 32FC1 [m]
  sensor_msgs::CameraInfo info;  // of both
};

FrameMessages frame_messages(const RgbdFrame& frame, const CameraModel& model, const ros::Time& stamp);
sensor_msgs::Image colour_message(const cv::Mat& colour, const std_msgs::Header& header);  // rgb8
// And back; the frame owns its pixels. Colour as rgb8 or bgr8, depth as 16UC1 [mm] or 32FC1 [m] (REP 118); what is not
// in (0, 65.535] m, as NaN, was not measured. Throws std::invalid_argument: field, value, allowed values.
cv::Mat colour_image(const sensor_msgs::Image& message);
RgbdFrame rgbd_frame(const std::string& camera, const sensor_msgs::Image& colour, const sensor_msgs::Image& depth);
// Throws std::invalid_argument: a lens other than plumb_bob with five coefficients or none, a matrix that is no
// camera's.
CameraModel camera_model(const sensor_msgs::CameraInfo& info);
geometry_msgs::TransformStamped transform_message(const std::string& parent, const std::string& child,
                                                  const Eigen::Isometry3d& parent_from_child);
Eigen::Isometry3d isometry(const geometry_msgs::Transform& message);

}  // namespace soft_robot_lab
