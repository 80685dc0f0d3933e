#include "soft_robot_lab/ros/image_messages.h"

#include <sensor_msgs/distortion_models.h>
#include <sensor_msgs/image_encodings.h>

namespace soft_robot_lab {
namespace {

sensor_msgs::Image image_message(const cv::Mat& image, const std_msgs::Header& header, const std::string& encoding) {
  sensor_msgs::Image message;
  message.header = header;
  message.height = static_cast<std::uint32_t>(image.rows);
  message.width = static_cast<std::uint32_t>(image.cols);
  message.encoding = encoding;
  message.step = static_cast<std::uint32_t>(static_cast<std::size_t>(image.cols) * image.elemSize());
  for (int row = 0; row < image.rows; ++row)
    message.data.insert(message.data.end(), image.ptr(row), image.ptr(row) + message.step);
  return message;
}

sensor_msgs::CameraInfo camera_info(const CameraModel& model, const std_msgs::Header& header) {
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(model.width_px);
  info.height = static_cast<std::uint32_t>(model.height_px);
  info.distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  info.D.assign(model.distortion.begin(), model.distortion.end());
  info.K = {model.focal_x_px, 0, model.centre_x_px, 0, model.focal_y_px, model.centre_y_px, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {model.focal_x_px, 0, model.centre_x_px, 0, 0, model.focal_y_px, model.centre_y_px, 0, 0, 0, 1, 0};
  return info;
}

}  // namespace

std::string optical_frame(const std::string& camera) { return camera + "_color_optical_frame"; }

FrameMessages frame_messages(const RgbdFrame& frame, const CameraModel& model, const ros::Time& stamp) {
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = optical_frame(frame.camera);
  return {image_message(frame.colour, header, sensor_msgs::image_encodings::RGB8),
          image_message(frame.depth, header, sensor_msgs::image_encodings::TYPE_16UC1), camera_info(model, header)};
}

geometry_msgs::TransformStamped transform_message(const std::string& parent, const std::string& child,
                                                  const Eigen::Isometry3d& parent_from_child) {
  geometry_msgs::TransformStamped message;
  message.header.frame_id = parent;
  message.child_frame_id = child;
  const Eigen::Vector3d translation_m = parent_from_child.translation();
  message.transform.translation.x = translation_m.x();
  message.transform.translation.y = translation_m.y();
  message.transform.translation.z = translation_m.z();
  const Eigen::Quaterniond rotation(parent_from_child.rotation());
  message.transform.rotation.x = rotation.x();
  message.transform.rotation.y = rotation.y();
  message.transform.rotation.z = rotation.z();
  message.transform.rotation.w = rotation.w();
  return message;
}

}  // namespace soft_robot_lab
