// SPDX-License-Identifier: BSD-3-Clause
#include "session_film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <rosbag/bag.h>
#include <visualization_msgs/Marker.h>

#include "ros/recording/recorded_topics.h"
#include "ros/base/topics.h"
#include "settings/write_file.h"
#include "soft_robot_lab/perception/tracking/camera_model.h"

namespace soft_robot_lab {
namespace {

using SkinMessage = visualization_msgs::Marker;

constexpr int rate_hz = 15, longest_s = 120;                                                     // of a film
constexpr int fraction_bits = 4;                                                                 // of drawn coordinates
const cv::Scalar simulated_colour(255, 90, 30), measured_colour(200, 40, 230), ink(60, 60, 60);  // blue, green, red

Eigen::Vector3d place_of(const geometry_msgs::Point& point) { return {point.x, point.y, point.z}; }

bool is_robot(const SkinMessage& surface) {
  return surface.type == SkinMessage::TRIANGLE_LIST && surface.points.size() >= 3 &&
         surface.colors.size() == surface.points.size();
}

template <typename Visit>
void visit_surfaces(const std::string& bag, const Visit& visit) {
  const rosbag::Bag opened = open_bag(bag);
  rosbag::View view = only(opened, {topics::simulator_surface});
  for (const rosbag::MessageInstance& message : view) {
    const auto surface = read_message<SkinMessage>(message);
    if (is_robot(*surface)) visit(*surface);
  }
}

// Around all that the robot's skin ever was.
Eigen::AlignedBox3d box_of(const std::string& bag) {
  constexpr double farthest_m = 100.0;
  Eigen::AlignedBox3d box_m;
  visit_surfaces(bag, [&](const SkinMessage& surface) {
    for (const auto& point : surface.points) {
      const Eigen::Vector3d position_m = place_of(point);
      if ((position_m.array().abs() < farthest_m).all()) box_m.extend(position_m);
    }
  });
  return box_m;
}

// From the side where rviz stands at first, a little above, as far off as shows all of the box.
class Eye {
 public:
  explicit Eye(const Eigen::AlignedBox3d& box_m) {
    constexpr double yaw_rad = 4.66, pitch_rad = 0.12;
    lens_.width_px = 640;
    lens_.height_px = 480;
    lens_.focal_x_px = lens_.focal_y_px = 1000.0;
    lens_.centre_x_px = 319.5;
    lens_.centre_y_px = 239.5;
    towards_ = -Eigen::Vector3d(std::cos(pitch_rad) * std::cos(yaw_rad), std::cos(pitch_rad) * std::sin(yaw_rad),
                                std::sin(pitch_rad));
    const Eigen::Vector3d right = towards_.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d world_from_eye;
    world_from_eye << right, towards_.cross(right), towards_;
    const double radius_m = 0.5 * box_m.diagonal().norm();
    const double distance_m = 1.1 * radius_m * lens_.focal_y_px / (0.5 * lens_.height_px);
    const Eigen::Vector3d position_m = box_m.center() - distance_m * towards_;
    eye_from_world_ = (Eigen::Translation3d(position_m) * Eigen::Quaterniond(world_from_eye)).inverse();
  }

  double depth_m(const Eigen::Vector3d& point_m) const { return (eye_from_world_ * point_m).z(); }
  const Eigen::Vector3d& towards() const { return towards_; }
  cv::Size size() const { return {lens_.width_px, lens_.height_px}; }

  std::optional<cv::Point> pixel(const Eigen::Vector3d& point_m) const {
    const Eigen::Vector3d in_eye = eye_from_world_ * point_m;
    if (!(in_eye.z() > 0.0)) return std::nullopt;
    const Eigen::Vector2d place_px = lens_.project(in_eye) * (1 << fraction_bits);
    if (!(place_px.array().abs() < 1e6).all()) return std::nullopt;  // what OpenCV's coordinates hold
    return cv::Point(static_cast<int>(std::lround(place_px.x())), static_cast<int>(std::lround(place_px.y())));
  }

 private:
  CameraModel lens_;
  Eigen::Vector3d towards_;
  Eigen::Isometry3d eye_from_world_;
};

struct Face {
  double depth_m;
  std::array<cv::Point, 3> corners;
  cv::Scalar colour;
};

std::optional<Face> face_of(const SkinMessage& surface, std::size_t first, const Eye& eye) {
  Face face{};
  std::array<Eigen::Vector3d, 3> positions_m;
  std_msgs::ColorRGBA colour;
  for (std::size_t k = 0; k < 3; ++k) {
    positions_m[k] = place_of(surface.points[first + k]);
    const std::optional<cv::Point> corner = eye.pixel(positions_m[k]);
    if (!corner) return std::nullopt;
    face.corners[k] = *corner;
    face.depth_m += eye.depth_m(positions_m[k]) / 3.0;
    const std_msgs::ColorRGBA& own = surface.colors[first + k];
    colour.r += own.r / 3.0f, colour.g += own.g / 3.0f, colour.b += own.b / 3.0f;
  }
  const Eigen::Vector3d normal = (positions_m[1] - positions_m[0]).cross(positions_m[2] - positions_m[0]).normalized();
  const double light = 255.0 * (0.45 + 0.55 * std::abs(normal.dot(eye.towards())));
  face.colour = light * cv::Scalar(colour.b, colour.g, colour.r);
  return face;
}

// What lies behind is painted first.
void paint_robot(const SkinMessage& surface, const Eye& eye, cv::Mat& picture) {
  std::vector<Face> faces;
  for (std::size_t i = 0; i + 2 < surface.points.size(); i += 3)
    if (const auto face = face_of(surface, i, eye); face && std::isfinite(face->colour[0])) faces.push_back(*face);
  std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.depth_m > b.depth_m; });
  for (const Face& face : faces)
    cv::fillConvexPoly(picture, face.corners.data(), 3, face.colour, cv::LINE_8, fraction_bits);
}

void paint_markers(const ObservedMarkers& at, bool seen_only, const cv::Scalar& colour, int radius_px, const Eye& eye,
                   cv::Mat& picture) {
  for (const ObservedMarker& marker : at.markers) {
    if (seen_only && !marker.seen) continue;
    if (const auto place = eye.pixel(marker.position_m))
      cv::circle(picture, *place, radius_px << fraction_bits, colour, 2, cv::LINE_AA, fraction_bits);
  }
}

void write(const std::string& text, cv::Point place_px, const cv::Scalar& colour, cv::Mat& picture) {
  cv::putText(picture, text, place_px, cv::FONT_HERSHEY_SIMPLEX, 0.5, colour, 1, cv::LINE_AA);
}

// The last of these until then.
const ObservedMarkers* at(const std::vector<ObservedMarkers>& all, double time_s) {
  const auto after = std::upper_bound(all.begin(), all.end(), time_s, [](double now_s, const ObservedMarkers& markers) {
    return now_s < markers.time_s;
  });
  return after == all.begin() ? nullptr : &*(after - 1);
}

std::string words_at(const std::vector<CommandsSince>& all, double time_s) {
  const auto after = std::upper_bound(all.begin(), all.end(), time_s,
                                      [](double now_s, const CommandsSince& since) { return now_s < since.time_s; });
  std::string words;
  if (after == all.begin()) return words;
  for (const auto& [name, value] : (after - 1)->values) {
    char text[96];
    std::snprintf(text, sizeof text, "%s%.40s %.4g", words.empty() ? "" : ", ", name.c_str(), value);
    words += text;
  }
  return words;
}

class FilmWriter {
 public:
  FilmWriter(const RecordedSession& recording, const Eye& eye, const std::string& folder)
      : recording_(recording), eye_(eye), film_{folder + "/session.mp4", 1.0, folder + "/session_film.png"} {
    const double duration_s = recording.end_s - recording.start_s;
    film_.speed = std::max(1.0, duration_s / longest_s);
    writer_.open(film_.file, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('a', 'v', 'c', '1'), rate_hz, eye_.size());
  }

  bool opened() const { return writer_.isOpened(); }

  // The skin as it was until now goes into all frames before this one was recorded.
  void show(const SkinMessage& surface) {
    write_until(surface.header.stamp.toSec());
    surface_ = surface;
  }

  std::optional<SessionFilm> finish() {
    write_until(recording_.end_s);
    writer_.release();
    if (middle_.empty()) return std::nullopt;
    std::vector<unsigned char> bytes;
    cv::imencode(".png", middle_, bytes);
    write_file(film_.middle, {bytes.begin(), bytes.end()});
    return film_;
  }

 private:
  double time_s(int frame) const { return recording_.start_s + frame * film_.speed / rate_hz; }

  void write_until(double end_s) {
    for (; time_s(frame_) < std::min(end_s, recording_.end_s); ++frame_) {
      if (!is_robot(surface_)) continue;  // no skin came yet
      const cv::Mat picture = draw(time_s(frame_));
      writer_.write(picture);
      if (middle_.empty() || time_s(frame_) < 0.5 * (recording_.start_s + recording_.end_s)) middle_ = picture;
    }
  }

  cv::Mat draw(double now_s) const {
    cv::Mat picture(eye_.size(), CV_8UC3, cv::Scalar::all(255));
    paint_robot(surface_, eye_, picture);
    if (const auto* simulated = at(recording_.simulated, now_s))
      paint_markers(*simulated, false, simulated_colour, 4, eye_, picture);
    if (const auto* measured = at(recording_.measured, now_s))
      paint_markers(*measured, true, measured_colour, 6, eye_, picture);
    char clock[64];
    std::snprintf(clock, sizeof clock, "%.1f s", now_s - recording_.start_s);
    write(clock, {12, 24}, ink, picture);
    write(words_at(recording_.commands, now_s), {12, eye_.size().height - 14}, ink, picture);
    write("simulated", {520, 24}, simulated_colour, picture);
    write("measured", {520, 44}, measured_colour, picture);
    return picture;
  }

  const RecordedSession& recording_;
  Eye eye_;
  SessionFilm film_;
  cv::VideoWriter writer_;
  SkinMessage surface_;
  cv::Mat middle_;
  int frame_ = 0;
};

}  // namespace

std::optional<SessionFilm> film_session(const std::string& bag, const RecordedSession& recording,
                                        const std::string& folder) {
  const Eigen::AlignedBox3d box_m = box_of(bag);
  if (box_m.isEmpty() || !(box_m.diagonal().norm() > 0.0) || !(recording.end_s > recording.start_s))
    return std::nullopt;
  FilmWriter film(recording, Eye(box_m), folder);
  if (!film.opened()) return std::nullopt;
  visit_surfaces(bag, [&](const SkinMessage& surface) { film.show(surface); });
  return film.finish();
}

}  // namespace soft_robot_lab
