// SPDX-License-Identifier: BSD-3-Clause
#include "robot_image.h"

#include "ros/base/log_text.h"
#include "ros/base/topics.h"
#include "ros/messages/frames.h"
#include "ros/messages/image_messages.h"

namespace soft_robot_lab {

RobotImage::RobotImage(ros::NodeHandle& node, const std::string& camera) : optical_frame_(optical_frame(camera)) {
  publisher_ = node.advertise<sensor_msgs::Image>(topics::overlay_image, 1);
  info_subscriber_ = node.subscribe(camera + "/color/camera_info", 1, &RobotImage::on_info, this);
  image_subscriber_ = node.subscribe(camera + "/color/image_raw", 1, &RobotImage::on_image, this);
  surface_subscriber_ = node.subscribe(topics::simulator_surface, 1, &RobotImage::on_surface, this);
}

void RobotImage::on_image(const sensor_msgs::Image& colour) {
  if (publisher_.getNumSubscribers() == 0 || !info_ || !surface_) return;
  try {
    const auto pose = frames_.lookupTransform(optical_frame_, robot_frame(), ros::Time(0));
    const Eigen::Isometry3d camera_from_robot = isometry(pose.transform);
    const CloseUp::View view = close_up_.of(colour_image(colour), camera_model(*info_), camera_from_robot, *surface_);
    const cv::Mat drawn = draw_robot(view.image, view.model, camera_from_robot, *surface_, gap_);
    publisher_.publish(colour_message(drawn, colour.header));
  } catch (const std::exception& error) {
    ROS_WARN_THROTTLE(5.0, "%s: %s", topics::overlay_image, log_text(error.what()).c_str());
  }
}

}  // namespace soft_robot_lab
