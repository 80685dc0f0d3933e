// SPDX-License-Identifier: BSD-3-Clause
#include "seen_robot.h"

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>

#include "ros/messages/frames.h"
#include "ros/base/stamps.h"
#include "ros/messages/conversions.h"
#include "ros/base/topics.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t most_markers = 64;        // a second at the usual step
constexpr double standing_still_m = 1.0e-4;     // the simulator sends a skin for less
constexpr double longest_velocity_gap_s = 0.1;  // two skins further apart give no velocity

void require_robot_frame(const std_msgs::Header& header, const std::string& topic) {
  try {
    prefix_of_robot(header.frame_id);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(topic + ": " + error.what());
  }
}

bool stand_still(const Eigen::Matrix3Xd& now_m, const Eigen::Matrix3Xd& then_m) {
  return now_m.cols() == 0 || (now_m - then_m).colwise().norm().maxCoeff() <= standing_still_m;
}

}  // namespace

JoinedSkin::JoinedSkin(const std::vector<geometry_msgs::Point>& points) : triangles_(3, points.size() / 3) {
  std::map<std::array<double, 3>, int> vertices;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::array<double, 3> key{points[i].x, points[i].y, points[i].z};
    triangles_(static_cast<Eigen::Index>(i)) =
        vertices.try_emplace(key, static_cast<int>(vertices.size())).first->second;
  }
  vertex_count_ = static_cast<Eigen::Index>(vertices.size());
}

std::optional<Eigen::Matrix3Xd> JoinedSkin::vertices_m(const std::vector<geometry_msgs::Point>& points) const {
  if (static_cast<Eigen::Index>(points.size()) != triangles_.size()) return std::nullopt;
  Eigen::Matrix3Xd vertices_m(3, vertex_count_);
  int placed = 0;  // vertices are numbered by their first corner
  for (Eigen::Index i = 0; i < triangles_.size(); ++i) {
    const geometry_msgs::Point& point = points[static_cast<std::size_t>(i)];
    const Eigen::Vector3d position_m(point.x, point.y, point.z);
    const int vertex = triangles_(i);
    if (vertex == placed) {
      vertices_m.col(vertex) = position_m;
      ++placed;
    } else if (vertices_m.col(vertex) != position_m) {
      return std::nullopt;
    }
  }
  return vertices_m;
}

void SeenRobotStates::add_markers(const MarkerObservations& message) {
  require_robot_frame(message.header, topics::simulator_markers);
  if (message.positions.size() != message.names.size())
    throw std::invalid_argument(std::string(topics::simulator_markers) + ": as many positions as names are needed");
  Markers markers{message.header.stamp, message.names, Eigen::Matrix3Xd(3, message.names.size())};
  for (std::size_t i = 0; i < message.names.size(); ++i)
    markers.positions_m.col(static_cast<Eigen::Index>(i)) = from_message(message.positions[i], "positions");
  if (!markers_.empty() && markers.stamp < markers_.back().stamp) forget();
  markers_.push_back(std::move(markers));
  if (markers_.size() > most_markers) markers_.pop_front();
  match();
}

void SeenRobotStates::add_surface(const visualization_msgs::Marker& surface) {
  if (surface.type != visualization_msgs::Marker::TRIANGLE_LIST || surface.action != visualization_msgs::Marker::ADD)
    return;
  require_robot_frame(surface.header, topics::simulator_surface);
  if (surface.points.size() % 3 != 0)
    throw std::invalid_argument(std::string(topics::simulator_surface) + ": points: " +
                                std::to_string(surface.points.size()) + " of them do not make triangles");
  for (const geometry_msgs::Point& point : surface.points) from_message(point, "points");
  auto vertices_m = skin_ ? skin_->vertices_m(surface.points) : std::nullopt;
  if (!vertices_m) {
    skin_.emplace(surface.points);
    vertices_m = skin_->vertices_m(surface.points);
    before_.reset();
    present_.reset();
    ++version_;
  }
  const bool back = surface.header.stamp < surface_stamp_;
  if (back && !markers_.empty() && markers_.front().stamp > surface.header.stamp) forget();
  surface_m_ = std::move(vertices_m);
  surface_stamp_ = surface.header.stamp;
  match();
}

// At the start of a new session, or of a bag played again.
void SeenRobotStates::forget() {
  markers_.clear();
  before_.reset();
  present_.reset();
  ++version_;
}

// Markers come more often than skins and from the same steps; a skin older than all of them is that of a body at rest.
void SeenRobotStates::match() {
  if (!surface_m_) return;
  const auto markers =
      std::find_if(markers_.begin(), markers_.end(), [&](const Markers& m) { return m.stamp >= surface_stamp_; });
  if (markers == markers_.end()) return;
  Moment moment{
      std::max(surface_stamp_, markers->stamp), markers->names, {std::move(*surface_m_), markers->positions_m}};
  surface_m_.reset();
  if (present_ && present_->names != moment.names) {
    present_.reset();
    ++version_;
  }
  before_ = std::move(present_);
  present_ = std::move(moment);
}

std::optional<SeenMoment> SeenRobotStates::newest() const {
  if (!present_) return std::nullopt;
  // The skin of the very last markers may still be on its way.
  if (!surface_m_ && markers_.size() >= 2) {
    const Markers& settled = markers_[markers_.size() - 2];
    if (settled.stamp > present_->stamp && settled.names == present_->names &&
        stand_still(settled.positions_m, present_->state.stickers_m))
      return SeenMoment{settled.stamp, {{present_->state.vertices_m, settled.positions_m}, {}, 0}};
  }
  SeenMoment moment{present_->stamp, {present_->state, {}, 0}};
  const bool moves = before_ && present_->stamp > before_->stamp &&
                     seconds_between(before_->stamp, present_->stamp) < longest_velocity_gap_s;
  if (moves) {
    moment.motion.before = before_->state;
    moment.motion.interval_s = seconds_between(before_->stamp, present_->stamp);
  }
  return moment;
}

}  // namespace soft_robot_lab
