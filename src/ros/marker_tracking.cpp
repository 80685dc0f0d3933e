#include "soft_robot_lab/ros/marker_tracking.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "soft_robot_lab/ros/conversions.h"
#include "soft_robot_lab/ros/image_messages.h"
#include "soft_robot_lab/ros/topics.h"

namespace soft_robot_lab {
namespace {

constexpr std::size_t most_simulated = 600;  // ten seconds at 60 Hz

MarkerObservations observations(const TrackerReport& report) {
  MarkerObservations message;
  message.header.stamp = ros::Time(report.stamp_s);
  message.header.frame_id = topics::robot_frame;
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

}  // namespace

void TrackingOptions::validate() const {
  if (cameras.empty()) throw std::invalid_argument("cameras: there are none; allowed: at least one name");
  const auto require = [](const char* field, double value) {
    if (!(value >= 0) || !std::isfinite(value))
      throw std::invalid_argument(std::string(field) + " is " + std::to_string(value) + "; allowed: [0, inf)");
  };
  require("slop_s", slop_s);
  require("patience_s", patience_s);
  require("simulated_before_s", simulated_before_s);
}

MarkerTracking::MarkerTracking(const TrackingOptions& options, const TrackerSettings& settings,
                               const std::vector<TrackedMarker>& markers)
    : options_((options.validate(), options)),
      markers_(markers),
      tracker_(settings, markers),
      joiner_(options.cameras, options.slop_s, options.patience_s) {}

void MarkerTracking::set_poses(const std::vector<CameraPose>& poses) {
  for (const CameraPose& pose : poses) {
    poses_[pose.name] = pose.world_from_camera;
    introduce(pose.name);
  }
  watch_.reset();
}

void MarkerTracking::add_info(const std::string& camera, const sensor_msgs::CameraInfo& info) {
  const CameraModel model = camera_model(info);
  const auto known = lenses_.find(camera);
  if (known != lenses_.end() && known->second.width_px == model.width_px &&
      known->second.height_px == model.height_px && known->second.focal_x_px == model.focal_x_px &&
      known->second.focal_y_px == model.focal_y_px && known->second.centre_x_px == model.centre_x_px &&
      known->second.centre_y_px == model.centre_y_px && known->second.distortion == model.distortion)
    return;
  lenses_[camera] = model;
  introduce(camera);
}

void MarkerTracking::introduce(const std::string& camera) {
  const auto pose = poses_.find(camera);
  const auto lens = lenses_.find(camera);
  if (pose == poses_.end() || lens == lenses_.end()) return;
  ready_[camera] = {camera, lens->second, pose->second};
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
  return track(joiner_.add(frame));
}

std::vector<MarkerTracking::Result> MarkerTracking::finish() { return track(joiner_.finish()); }

void MarkerTracking::reset() {
  tracker_.reset();
  joiner_.reset();
  watch_.reset();
  simulated_.clear();
}

std::vector<MarkerTracking::Result> MarkerTracking::track(std::vector<std::vector<RgbdFrame>> groups) {
  std::vector<Result> results;
  for (std::vector<RgbdFrame>& group : groups) {
    double newest_s = group.front().stamp_s;
    for (const RgbdFrame& frame : group) newest_s = std::max(newest_s, frame.stamp_s);
    refer(newest_s - options_.simulated_before_s);
    Result result;
    result.report = tracker_.update(group);
    if (result.report.updated) {
      result.observations = observations(result.report);
      watch_.add(result.report.stamp_s, result.report.sights);
    }
    result.frames = std::move(group);
    results.push_back(std::move(result));
  }
  return results;
}

// The newest simulated markers that are not newer than this.
void MarkerTracking::refer(double stamp_s) {
  while (simulated_.size() > 1 && simulated_[1].stamp_s <= stamp_s) simulated_.pop_front();
  if (!simulated_.empty() && simulated_.front().stamp_s <= stamp_s)
    tracker_.set_simulated(simulated_.front().positions_m);
}

}  // namespace soft_robot_lab
