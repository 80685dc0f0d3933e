// SPDX-License-Identifier: BSD-3-Clause
#include "image_messages.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <sensor_msgs/distortion_models.h>
#include <sensor_msgs/image_encodings.h>

#include "conversions.h"
#include "frames.h"
#include "settings/limits.h"

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
  namespace models = sensor_msgs::distortion_models;
  const auto plain = model.distortion.begin() + 5;
  const bool rational = std::any_of(plain, model.distortion.end(), [](double d) { return d != 0; });
  info.distortion_model = rational ? models::RATIONAL_POLYNOMIAL : models::PLUMB_BOB;
  info.D.assign(model.distortion.begin(), rational ? model.distortion.end() : plain);
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
  if (message.step < row || message.step % CV_ELEM_SIZE1(type) != 0 ||
      message.data.size() < static_cast<std::size_t>(message.step) * message.height)
    throw std::invalid_argument(what + ": data holds " + std::to_string(message.data.size()) + " bytes in rows of " +
                                std::to_string(message.step) + "; its size needs rows of " + std::to_string(row));
  if (message.is_bigendian) throw std::invalid_argument(what + ": is_bigendian is set; allowed: little-endian pixels");
  return cv::Mat(static_cast<int>(message.height), static_cast<int>(message.width), type,
                 const_cast<std::uint8_t*>(message.data.data()), message.step);
}

constexpr double millimetre_m = 0.001;
constexpr double most_depth_m = limits::kDepth_m;  // that 16 bits hold

bool is_whole_millimetres(double step_m) {
  const double steps = step_m / millimetre_m;
  return steps > 0.5 && std::abs(steps - std::round(steps)) < 1e-9 * steps;
}

sensor_msgs::Image depth_message(const RgbdFrame& frame, const std_msgs::Header& header) {
  if (!is_whole_millimetres(frame.depth_step_m))
    return image_message(frame.depth_m, header, sensor_msgs::image_encodings::TYPE_32FC1);
  cv::Mat depth;
  cv::threshold(frame.depth_m, depth, most_depth_m, 0, cv::THRESH_TOZERO_INV);
  depth.convertTo(depth, CV_16U, 1 / millimetre_m);
  return image_message(depth, header, sensor_msgs::image_encodings::TYPE_16UC1);
}

// The frame's depths and their step.
void read_depth(const sensor_msgs::Image& message, RgbdFrame& frame) {
  if (message.encoding == sensor_msgs::image_encodings::TYPE_16UC1 ||
      message.encoding == sensor_msgs::image_encodings::MONO16) {
    view(message, CV_16UC1, "depth").convertTo(frame.depth_m, CV_32F, millimetre_m);
    frame.depth_step_m = millimetre_m;
  } else if (message.encoding == sensor_msgs::image_encodings::TYPE_32FC1) {
    const cv::Mat depth_m = view(message, CV_32FC1, "depth");
    const cv::Mat known =
        (depth_m > 0) & (depth_m < std::numeric_limits<float>::max());  // what sees nothing may be inf
    const int measured = cv::countNonZero(known), too_far = cv::countNonZero(known & (depth_m > most_depth_m));
    if (2 * too_far > measured)
      throw std::invalid_argument("depth: most of its 32FC1 values are above " + std::to_string(most_depth_m) +
                                  "; allowed: metres");
    frame.depth_m = cv::Mat::zeros(depth_m.size(), CV_32FC1);
    depth_m.copyTo(frame.depth_m, (depth_m > 0) & (depth_m <= most_depth_m));  // no NaN is either
  } else {
    throw std::invalid_argument("depth: encoding '" + message.encoding + "' is not one of 16UC1, mono16, 32FC1");
  }
}

}  // namespace

sensor_msgs::Image colour_message(const cv::Mat& colour, const std_msgs::Header& header) {
  return image_message(colour, header, sensor_msgs::image_encodings::RGB8);
}

FrameMessages frame_messages(const RgbdFrame& frame, const CameraModel& model, const ros::Time& stamp) {
  std_msgs::Header header;
  header.stamp = stamp;
  header.frame_id = optical_frame(frame.camera);
  return {colour_message(frame.colour, header), depth_message(frame, header), camera_info(model, header)};
}

cv::Mat colour_image(const sensor_msgs::Image& message) {
  namespace encodings = sensor_msgs::image_encodings;
  if (message.encoding == encodings::RGB8) return view(message, CV_8UC3, "colour").clone();
  static const std::map<std::string, std::pair<int, int>> others = {{encodings::BGR8, {CV_8UC3, cv::COLOR_BGR2RGB}},
                                                                    {encodings::RGBA8, {CV_8UC4, cv::COLOR_RGBA2RGB}},
                                                                    {encodings::BGRA8, {CV_8UC4, cv::COLOR_BGRA2RGB}}};
  const auto other = others.find(message.encoding);
  if (other == others.end())
    throw std::invalid_argument("colour: encoding '" + message.encoding + "' is not one of rgb8, bgr8, rgba8, bgra8");
  cv::Mat colour;
  cv::cvtColor(view(message, other->second.first, "colour"), colour, other->second.second);
  return colour;
}

RgbdFrame rgbd_frame(const std::string& camera, const sensor_msgs::Image& colour, const sensor_msgs::Image& depth) {
  RgbdFrame frame{camera, colour.header.stamp.toSec(), colour_image(colour), {}};
  read_depth(depth, frame);
  return frame;
}

CameraModel camera_model(const sensor_msgs::CameraInfo& info) {
  CameraModel model;
  model.width_px = static_cast<int>(info.width);
  model.height_px = static_cast<int>(info.height);
  model.focal_x_px = info.K[0];
  model.centre_x_px = info.K[2];
  model.focal_y_px = info.K[4];
  model.centre_y_px = info.K[5];
  namespace models = sensor_msgs::distortion_models;
  const auto zero = [](double d) { return d == 0; };
  const auto used = static_cast<std::ptrdiff_t>(std::min(info.D.size(), model.distortion.size()));
  const bool known =
      (info.distortion_model == models::PLUMB_BOB && info.D.size() == 5) ||
      (info.distortion_model == models::RATIONAL_POLYNOMIAL && info.D.size() >= model.distortion.size() &&
       std::all_of(info.D.begin() + used, info.D.end(), zero));  // OpenCV's thin prism and tilt come after
  if (!known && !std::all_of(info.D.begin(), info.D.end(), zero))
    throw std::invalid_argument("camera_info: distortion_model '" + info.distortion_model + "' with " +
                                std::to_string(info.D.size()) +
                                " coefficients; allowed: plumb_bob with 5, rational_polynomial with 8, or all zero");
  if (known) std::copy(info.D.begin(), info.D.begin() + used, model.distortion.begin());
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
  message.transform.translation = vector_message(parent_from_child.translation());
  message.transform.rotation = to_message(Eigen::Quaterniond(parent_from_child.rotation()));
  return message;
}

Eigen::Isometry3d isometry(const geometry_msgs::Transform& message) {
  const auto& t = message.translation;
  const auto& r = message.rotation;
  return Eigen::Translation3d(t.x, t.y, t.z) * Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized();
}

}  // namespace soft_robot_lab
