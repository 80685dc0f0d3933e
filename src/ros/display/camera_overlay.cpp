// SPDX-License-Identifier: BSD-3-Clause
#include "camera_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "ros/messages/conversions.h"

namespace soft_robot_lab {
namespace {

const cv::Scalar robot_paint(30, 90, 255), measured_paint(230, 40, 200), error_paint(255, 40, 40);
constexpr int kFractionBits = 4;  // of drawn coordinates

// Nothing behind the camera.
std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point_m, const CameraModel& model,
                                       const Eigen::Isometry3d& camera_from_robot) {
  const Eigen::Vector3d in_camera = camera_from_robot * point_m;
  if (!(in_camera.z() > 0.0)) return std::nullopt;
  return model.project(in_camera);
}

class ImageDrawing {
 public:
  ImageDrawing(const cv::Mat& colour, const CameraModel& model, const Eigen::Isometry3d& camera_from_robot)
      : image_(colour.clone()), model_(model), camera_from_robot_(camera_from_robot) {}

  void robot(const visualization_msgs::Marker& surface) {
    cv::Mat mask(image_.size(), CV_8UC1, cv::Scalar(0));
    for (size_t i = 0; i + 2 < surface.points.size(); i += 3) {
      std::array<cv::Point, 3> corners;
      bool seen = true;
      for (size_t k = 0; k < 3; ++k) {
        const std::optional<cv::Point> corner = pixel(from_message(surface.points[i + k], "points"));
        seen = seen && corner;
        if (corner) corners[k] = *corner;
      }
      if (seen) cv::fillConvexPoly(mask, corners.data(), 3, cv::Scalar(255), cv::LINE_8, kFractionBits);
    }
    cv::Mat tinted;
    cv::addWeighted(image_, 0.65, cv::Mat(image_.size(), image_.type(), robot_paint), 0.35, 0.0, tinted);
    tinted.copyTo(image_, mask);
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(mask, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
    cv::drawContours(image_, outlines, -1, robot_paint, 1, cv::LINE_AA);
  }

  void gap(const RealityGap& gap) {
    for (size_t i = 0; i < gap.names.size(); ++i) {
      if (gap.seen[i] == 0) continue;
      const Eigen::Vector3d measured_m = from_message(gap.measured[i], "measured");
      const Eigen::Vector3d gap_m(gap.gaps[i].x, gap.gaps[i].y, gap.gaps[i].z);
      const auto from = pixel(measured_m - gap_m), to = pixel(measured_m);
      if (!from || !to) continue;
      cv::line(image_, *from, *to, error_paint, 1, cv::LINE_AA, kFractionBits);
      cv::circle(image_, *from, 3 << kFractionBits, robot_paint, 1, cv::LINE_AA, kFractionBits);
      cv::circle(image_, *to, 3 << kFractionBits, measured_paint, 1, cv::LINE_AA, kFractionBits);
    }
    char text[64];
    std::snprintf(text, sizeof text, "gap %.2f mm rms", 1e3 * gap.rms_m);
    cv::putText(image_, text, {8, 18}, cv::FONT_HERSHEY_SIMPLEX, 0.5, error_paint, 1, cv::LINE_AA);
  }

  cv::Mat finished() const { return image_; }

 private:
  std::optional<cv::Point> pixel(const Eigen::Vector3d& point_m) const {
    const std::optional<Eigen::Vector2d> seen_px = project(point_m, model_, camera_from_robot_);
    if (!seen_px) return std::nullopt;
    const Eigen::Vector2d place_px = *seen_px * (1 << kFractionBits);
    constexpr double far_px = 1e6;  // what OpenCV's coordinates hold
    if (!(place_px.cwiseAbs().maxCoeff() < far_px)) return std::nullopt;
    return cv::Point(static_cast<int>(std::lround(place_px.x())), static_cast<int>(std::lround(place_px.y())));
  }

  cv::Mat image_;
  const CameraModel& model_;
  Eigen::Isometry3d camera_from_robot_;
};

// Around all of the robot that is in the image; empty where nothing is.
Eigen::AlignedBox2d box_of(const visualization_msgs::Marker& surface, const CameraModel& model,
                           const Eigen::Isometry3d& camera_from_robot) {
  Eigen::AlignedBox2d box_px;
  for (const geometry_msgs::Point& point : surface.points) {
    const std::optional<Eigen::Vector2d> place_px = project(from_message(point, "points"), model, camera_from_robot);
    if (place_px && model.sees(*place_px)) box_px.extend(*place_px);
  }
  return box_px;
}

}  // namespace

cv::Mat draw_robot(const cv::Mat& colour, const CameraModel& model, const Eigen::Isometry3d& camera_from_robot,
                   const visualization_msgs::Marker& surface, const std::optional<RealityGap>& gap) {
  ImageDrawing drawing(colour, model, camera_from_robot);
  drawing.robot(surface);
  if (gap) drawing.gap(*gap);
  return drawing.finished();
}

CloseUp::View CloseUp::of(const cv::Mat& image, const CameraModel& model, const Eigen::Isometry3d& camera_from_robot,
                          const visualization_msgs::Marker& surface) {
  constexpr double margin = 1.5, least = 0.1;  // of the robot's size, and of the image
  const Eigen::Vector2d all_px(image.cols, image.rows);
  const Eigen::AlignedBox2d robot_px = box_of(surface, model, camera_from_robot);
  if (robot_px.isEmpty()) return {image, model};
  const double fraction = std::clamp(margin * robot_px.sizes().cwiseQuotient(all_px).maxCoeff(), least, 1.0);
  const bool fits = window_px_.contains(robot_px) && window_px_.sizes().x() < 1.5 * fraction * all_px.x() &&
                    (window_px_.max().array() <= all_px.array()).all();
  if (!fits) {
    const Eigen::Vector2d size_px = (fraction * all_px).array().round();
    const Eigen::Vector2d corner_px = (robot_px.center() - 0.5 * size_px).cwiseMax(0.0).cwiseMin(all_px - size_px);
    window_px_ = {corner_px.array().round(), corner_px.array().round() + size_px.array()};
  }
  const Eigen::Vector2d corner_px = window_px_.min(), size_px = window_px_.sizes();
  const Eigen::Vector2d larger = all_px.cwiseQuotient(size_px);
  View view{cv::Mat(), model};
  cv::resize(image(cv::Rect2d(corner_px.x(), corner_px.y(), size_px.x(), size_px.y())), view.image, image.size(), 0.0,
             0.0, cv::INTER_CUBIC);
  view.model.focal_x_px *= larger.x();
  view.model.focal_y_px *= larger.y();
  view.model.centre_x_px = (model.centre_x_px - corner_px.x() + 0.5) * larger.x() - 0.5;
  view.model.centre_y_px = (model.centre_y_px - corner_px.y() + 0.5) * larger.y() - 0.5;
  return view;
}

}  // namespace soft_robot_lab
