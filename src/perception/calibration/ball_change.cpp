// SPDX-License-Identifier: BSD-3-Clause
#include "ball_change.h"

#include <stdexcept>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace soft_robot_lab {
namespace {

struct MeanPicture {
  cv::Mat colour;   // CV_32FC3, 0 to 1
  cv::Mat depth_m;  // CV_32FC1; 0 where fewer than half of the pictures have a depth
};

std::string size_text(const cv::Mat& image) { return std::to_string(image.cols) + " x " + std::to_string(image.rows); }

void require_usable(const RgbdFrame& frame, const CameraModel& camera) {
  const std::string who = "a picture of " + (frame.camera.empty() ? std::string("a camera") : frame.camera);
  if (frame.colour.type() != CV_8UC3 || frame.depth_m.type() != CV_32FC1)
    throw std::invalid_argument(who + " has an unknown encoding; allowed: rgb8 with depth in 32FC1");
  for (const cv::Mat* image : {&frame.colour, &frame.depth_m})
    if (image->size() != cv::Size(camera.width_px, camera.height_px))
      throw std::invalid_argument(who + " has " + size_text(*image) + " pixels; allowed: the camera's " +
                                  std::to_string(camera.width_px) + " x " + std::to_string(camera.height_px) +
                                  " for colour and depth");
}

MeanPicture mean_picture(const std::vector<RgbdFrame>& frames, const CameraModel& camera, const DepthSettings& depths,
                         const std::string& kind) {
  if (frames.empty()) throw std::invalid_argument("there is no picture " + kind + " balls; at least one is needed");
  const cv::Size size(camera.width_px, camera.height_px);
  cv::Mat colour(size, CV_32FC3, cv::Scalar::all(0)), depth_m(size, CV_32FC1, cv::Scalar(0));
  cv::Mat count(size, CV_32FC1, cv::Scalar(0));
  for (const RgbdFrame& frame : frames) {
    require_usable(frame, camera);
    const cv::Mat measured = (frame.depth_m >= depths.min_m) & (frame.depth_m <= depths.max_m);
    cv::accumulate(frame.colour, colour);
    cv::accumulate(frame.depth_m, depth_m, measured);
    cv::add(count, 1, count, measured);
  }
  const double frame_count = static_cast<double>(frames.size());
  MeanPicture mean;
  mean.colour = colour / (255 * frame_count);
  cv::divide(depth_m, count, mean.depth_m);
  mean.depth_m.setTo(0, count < 0.5 * frame_count);
  return mean;
}

}  // namespace

BallChange find_change(const std::vector<RgbdFrame>& without_balls, const std::vector<RgbdFrame>& with_balls,
                       const CameraModel& camera, const BallFinderSettings& settings) {
  const MeanPicture before = mean_picture(without_balls, camera, settings.depth, "without");
  const MeanPicture after = mean_picture(with_balls, camera, settings.depth, "with");
  BallChange change;
  change.depth_m = after.depth_m;
  change.depth_count = static_cast<int>(with_balls.size());
  cv::transform(after.colour - before.colour, change.brightness, cv::Matx13f(1 / 3.f, 1 / 3.f, 1 / 3.f));
  const cv::Mat nearer =
      (after.depth_m > 0) & (before.depth_m > 0) & (before.depth_m - after.depth_m > settings.depth_change_m);
  cv::Mat changed = (cv::abs(change.brightness) > settings.colour_change) | nearer;
  cv::morphologyEx(changed, change.mask, cv::MORPH_OPEN, cv::Mat::ones(3, 3, CV_8UC1));
  return change;
}

}  // namespace soft_robot_lab
