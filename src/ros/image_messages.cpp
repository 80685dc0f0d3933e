#include "soft_robot_lab/ros/image_messages.h"

#include <algorithm>
#include <stdexcept>

#include <opencv2/imgproc.hpp>
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

// A view of the message's pixels.
cv::Mat view(const sensor_msgs::Image& message, int type, const std::string& what) {
  const std::size_t row = static_cast<std::size_t>(message.width) * CV_ELEM_SIZE(type);
  if (message.width == 0 || message.height == 0)
    throw std::invalid_argument(what + ": an image of " + std::to_string(message.width) + " x " +
                                std::to_string(message.height) + " pixels; allowed: at least 1 x 1");
  if (message.step < row || message.data.size() < static_cast<std::size_t>(message.step) * message.height)
    throw std::invalid_argument(what + ": data holds " + std::to_string(message.data.size()) + " bytes in rows of " +
                                std::to_string(message.step) + "; its size needs rows of " + std::to_string(row));
  if (message.is_bigendian) throw std::invalid_argument(what + ": is_bigendian is set; allowed: little-endian pixels");
  return cv::Mat(static_cast<int>(message.height), static_cast<int>(message.width), type,
                 const_cast<std::uint8_t*>(message.data.data()), message.step);
}

cv::Mat depth_of(const sensor_msgs::Image& message) {
  if (message.encoding == sensor_msgs::image_encodings::TYPE_16UC1) return view(message, CV_16UC1, "depth").clone();
  if (message.encoding != sensor_msgs::image_encodings::TYPE_32FC1)
    throw std::invalid_argument("depth: encoding '" + message.encoding + "' is not one of 16UC1, 32FC1");
  const cv::Mat metres = view(message, CV_32FC1, "depth");
  cv::Mat depth(metres.size(), CV_16UC1);
  for (int row = 0; row < metres.rows; ++row)
    for (int column = 0; column < metres.cols; ++column) {
      const float mm = 1000.0F * metres.at<float>(row, column);
      const bool measured = mm >= 0.5F && mm < 65535.0F;  // false for NaN too
      depth.at<std::uint16_t>(row, column) = measured ? static_cast<std::uint16_t>(mm + 0.5F) : std::uint16_t{0};
    }
  return depth;
}

}  // namespace

cv::Mat colour_of(const sensor_msgs::Image& message) {
  if (message.encoding == sensor_msgs::image_encodings::RGB8) return view(message, CV_8UC3, "colour").clone();
  if (message.encoding != sensor_msgs::image_encodings::BGR8)
    throw std::invalid_argument("colour: encoding '" + message.encoding + "' is not one of rgb8, bgr8");
  cv::Mat colour;
  cv::cvtColor(view(message, CV_8UC3, "colour"), colour, cv::COLOR_BGR2RGB);
  return colour;
}

std::string optical_frame(const std::string& camera) { return camera + "_color_optical_frame"; }

sensor_msgs::Image colour_message(const cv::Mat& colour, const std_msgs::Header& header) {
  return image_message(colour, header, sensor_msgs::image_encodings::RGB8);
}

FrameMessages frame_messages(const RgbdFrame& frame, const CameraModel& model, const ros::Time& stamp) {
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = optical_frame(frame.camera);
  return {colour_message(frame.colour, header),
          image_message(frame.depth, header, sensor_msgs::image_encodings::TYPE_16UC1), camera_info(model, header)};
}

cv::Mat colour_image(const sensor_msgs::Image& message) {
  if (message.encoding == sensor_msgs::image_encodings::RGB8) return view(message, CV_8UC3, "colour").clone();
  if (message.encoding != sensor_msgs::image_encodings::BGR8)
    throw std::invalid_argument("colour: encoding '" + message.encoding + "' is not one of rgb8, bgr8");
  cv::Mat colour;
  cv::cvtColor(view(message, CV_8UC3, "colour"), colour, cv::COLOR_BGR2RGB);
  return colour;
}

RgbdFrame rgbd_frame(const std::string& camera, const sensor_msgs::Image& colour, const sensor_msgs::Image& depth) {
  return {camera, colour.header.stamp.toSec(), colour_image(colour), depth_of(depth)};
}

CameraModel camera_model(const sensor_msgs::CameraInfo& info) {
  CameraModel model;
  model.width_px = static_cast<int>(info.width);
  model.height_px = static_cast<int>(info.height);
  model.focal_x_px = info.K[0];
  model.centre_x_px = info.K[2];
  model.focal_y_px = info.K[4];
  model.centre_y_px = info.K[5];
  const bool straight = std::all_of(info.D.begin(), info.D.end(), [](double d) { return d == 0; });
  if (!straight && (info.distortion_model != sensor_msgs::distortion_models::PLUMB_BOB || info.D.size() != 5))
    throw std::invalid_argument("camera_info: distortion_model '" + info.distortion_model + "' with " +
                                std::to_string(info.D.size()) +
                                " coefficients; allowed: plumb_bob with 5, or all zero");
  if (!straight) std::copy(info.D.begin(), info.D.end(), model.distortion.begin());
  try {
    model.validate();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("camera_info: ") + error.what());
  }
  return model;
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

Eigen::Isometry3d isometry(const geometry_msgs::Transform& message) {
  const auto& t = message.translation;
  const auto& r = message.rotation;
  return Eigen::Translation3d(t.x, t.y, t.z) * Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized();
}

}  // namespace soft_robot_lab
