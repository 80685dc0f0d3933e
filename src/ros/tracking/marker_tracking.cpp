// SPDX-License-Identifier: BSD-3-Clause
#include "marker_tracking.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include <ros/names.h>

#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "ros/messages/image_messages.h"
#include "ros/base/topics.h"
#include "settings/require_in_range.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t most_simulated = 600;  // ten seconds at 60 Hz

MarkerObservations observations(const TrackerReport& report) {
  MarkerObservations message;
  message.header.stamp = ros::Time(report.stamp_s);
  message.header.frame_id = robot_frame();
  for (const MarkerObservation& marker : report.markers) {
    message.names.push_back(marker.name);
    message.positions.push_back(to_message(marker.position_m));
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) message.covariances.push_back(marker.covariance_m2(row, column));
    message.sources.push_back(marker.source == MarkerSource::seen ? MarkerObservations::SEEN
                                                                  : MarkerObservations::INTERPOLATED);
  }
  return message;
}

constexpr std::size_t pose_numbers = 12;

Eigen::Isometry3d pose_from(const double* row_by_row) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) pose.matrix()(row, column) = *row_by_row++;
  return pose;
}

bool alike(const CameraModel& a, const CameraModel& b) {
  return a.width_px == b.width_px && a.height_px == b.height_px && a.focal_x_px == b.focal_x_px &&
         a.focal_y_px == b.focal_y_px && a.centre_x_px == b.centre_x_px && a.centre_y_px == b.centre_y_px &&
         a.distortion == b.distortion;
}

}  // namespace

void TrackingOptions::validate() const {
  if (cameras.empty()) throw std::invalid_argument("cameras: there are none; allowed: at least one name");
  std::set<std::string> names;
  for (const std::string& camera : cameras) {
    std::string ignored;
    if (camera.empty() || !ros::names::validate(camera, ignored))
      throw std::invalid_argument("cameras: '" + camera +
                                  "' begins no topic; allowed: a letter, then letters, digits, _ and /");
    if (!names.insert(camera).second) throw std::invalid_argument("cameras: '" + camera + "' is named twice");
  }
  require_in_range("sync_tolerance_s", sync_tolerance_s, AllowedRange::not_negative());
  require_in_range("sync_timeout_s", sync_timeout_s, AllowedRange::not_negative());
  require_in_range("simulated_before_s", simulated_before_s, AllowedRange::not_negative());
}

MarkerTracking::MarkerTracking(const TrackingOptions& options, const TrackerSettings& settings,
                               const std::vector<TrackedMarker>& markers)
    : options_((options.validate(), options)),
      markers_(markers),
      tracker_(settings, markers),
      joiner_(options.cameras, options.sync_tolerance_s, options.sync_timeout_s) {}

void MarkerTracking::set_poses(const std::vector<CameraPose>& poses) {
  for (const CameraPose& pose : poses) {
    poses_[pose.name] = pose.world_from_camera;
    introduce(pose.name);
  }
  watch_.reset();
}

void MarkerTracking::set_settings(const TrackerSettings& settings) {
  Tracker changed(settings, markers_);
  for (const auto& [name, camera] : ready_) changed.set_camera(camera);
  changed.set_state(tracker_.state());
  tracker_ = std::move(changed);
}

void MarkerTracking::add_info(const std::string& camera, const sensor_msgs::CameraInfo& info) {
  const CameraModel model = camera_model(info);
  const auto known = infos_.find(camera);
  if (known != infos_.end() && alike(camera_model(known->second), model)) return;
  infos_[camera] = info;
  introduce(camera);
}

void MarkerTracking::introduce(const std::string& camera) {
  const auto pose = poses_.find(camera);
  const auto info = infos_.find(camera);
  if (pose == poses_.end() || info == infos_.end()) return;
  ready_[camera] = {camera, camera_model(info->second), pose->second};
  tracker_.set_camera(ready_[camera]);
}

void MarkerTracking::add_simulated(const MarkerObservations& message) {
  Simulated simulated{message.header.stamp.toSec(), {}};
  for (const TrackedMarker& marker : markers_) simulated.positions_m.push_back(position_of(message, marker.name));
  if (!simulated_.empty() && simulated.stamp_s < simulated_.back().stamp_s) reset();
  simulated_.push_back(std::move(simulated));
  if (simulated_.size() > most_simulated) simulated_.pop_front();
}

std::vector<MarkerTracking::Result> MarkerTracking::add(const RgbdFrame& frame) {
  if (ready_.count(frame.camera) == 0) {
    ++unusable_frames_;
    return {};
  }
  follow_clock(frame);
  return track(joiner_.add(frame));
}

// Frames of before may still come after the simulation's clock was set back; none after them would count as newer.
void MarkerTracking::follow_clock(const RgbdFrame& frame) {
  constexpr double longest_back_s = 1.0;  // of frames that merely overtook each other
  const auto newest = newest_s_.find(frame.camera);
  if (newest != newest_s_.end() && frame.stamp_s < newest->second - longest_back_s) reset();
  double& newest_s = newest_s_.try_emplace(frame.camera, frame.stamp_s).first->second;
  newest_s = std::max(newest_s, frame.stamp_s);
}

std::vector<MarkerTracking::Result> MarkerTracking::finish() { return track(joiner_.finish()); }

void MarkerTracking::reset() {
  tracker_.reset();
  joiner_.reset();
  watch_.reset();
  simulated_.clear();
  newest_s_.clear();
  ++next_step_;  // which then does not follow the one before
}

std::vector<MarkerTracking::Result> MarkerTracking::track(std::vector<std::vector<RgbdFrame>> groups) {
  std::vector<Result> results;
  for (std::vector<RgbdFrame>& group : groups) {
    double newest_s = group.front().stamp_s;
    for (const RgbdFrame& frame : group) newest_s = std::max(newest_s, frame.stamp_s);
    results.push_back(update(std::move(group), simulated_before(newest_s - options_.simulated_before_s)));
  }
  return results;
}

MarkerTracking::Result MarkerTracking::repeat(const TrackerUpdateLog& step, std::vector<RgbdFrame> frames) {
  const std::size_t cameras = step.cameras.size();
  if (step.camera_infos.size() != cameras || step.world_from_camera.size() != pose_numbers * cameras)
    throw std::invalid_argument(std::string(topics::tracker_steps) + ": lists of different lengths");
  for (std::size_t i = 0; i < cameras; ++i) {
    poses_[step.cameras[i]] = pose_from(&step.world_from_camera[pose_numbers * i]);
    infos_[step.cameras[i]] = step.camera_infos[i];
    introduce(step.cameras[i]);
  }
  if (!follows(step)) tracker_.set_state(step.state);
  next_step_ = step.number;
  std::vector<Eigen::Vector3d> simulated_m;
  for (const geometry_msgs::Point& point : step.simulated) simulated_m.push_back(from_message(point, "simulated"));
  return update(std::move(frames), simulated_m);
}

// `simulated_m`: empty where nothing new is known of them.
MarkerTracking::Result MarkerTracking::update(std::vector<RgbdFrame> group,
                                              const std::vector<Eigen::Vector3d>& simulated_m) {
  Result result;
  result.step.state = tracker_.state();
  if (!simulated_m.empty()) tracker_.set_simulated(simulated_m);
  result.report = tracker_.update(group);
  if (result.report.updated) {
    result.observations = observations(result.report);
    result.step.header = result.observations.header;
    for (const Eigen::Vector3d& position_m : simulated_m) result.step.simulated.push_back(to_message(position_m));
    describe(group, result.report.cameras, result.step);
    watch_.add(result.report.stamp_s, result.report.sights);
  }
  result.frames = std::move(group);
  return result;
}

// Number, markers, and those frames of the group that were used.
void MarkerTracking::describe(const std::vector<RgbdFrame>& group, const std::vector<std::string>& used,
                              TrackerUpdateLog& step) {
  step.number = next_step_++;
  for (const TrackedMarker& marker : markers_) {
    step.markers.push_back(marker.name);
    step.rest.push_back(to_message(marker.rest_position_m));
  }
  for (const RgbdFrame& frame : group) {
    if (std::find(used.begin(), used.end(), frame.camera) == used.end()) continue;
    step.cameras.push_back(frame.camera);
    step.stamps_s.push_back(frame.stamp_s);
    step.camera_infos.push_back(infos_.at(frame.camera));
    const auto pose = poses_.at(frame.camera).matrix();
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) step.world_from_camera.push_back(pose(row, column));
  }
}

// The newest simulated markers that are not newer than this; none where there are none.
std::vector<Eigen::Vector3d> MarkerTracking::simulated_before(double stamp_s) {
  while (simulated_.size() > 1 && simulated_[1].stamp_s <= stamp_s) simulated_.pop_front();
  if (simulated_.empty() || simulated_.front().stamp_s > stamp_s) return {};
  return simulated_.front().positions_m;
}

}  // namespace soft_robot_lab
