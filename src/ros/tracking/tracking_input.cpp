// SPDX-License-Identifier: BSD-3-Clause
#include "tracking_input.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "ros/base/actuator_plugins.h"
#include "ros/messages/image_messages.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {
namespace {

std::vector<TrackedMarker> markers_of(const std::string& scene_path) {
  SceneOptions options;
  options.actuator_factory = actuators_from_plugins();
  options.reduced = ReducedUse::by_newton;
  const Scene scene = load_scene(scene_path, options);
  std::vector<TrackedMarker> markers;
  for (const Marker& marker : scene.simulation->markers()) markers.push_back({marker.name(), marker.rest_position_m()});
  return markers;
}

}  // namespace

std::string colour_topic(const std::string& camera) { return camera + "/color/image_raw"; }
std::string depth_topic(const std::string& camera) { return camera + "/aligned_depth_to_color/image_raw"; }
std::string info_topic(const std::string& camera) { return camera + "/color/camera_info"; }

TrackingInput::TrackingInput(TrackingInputOptions options, OnResult on_result)
    : options_(std::move(options)), settings_(load_tracker(options_.tracker)), on_result_(std::move(on_result)) {
  options_.tracking.validate();
  for (const std::string& file : {options_.poses, options_.default_poses})
    if (poses_file_.empty() && std::filesystem::exists(file)) poses_file_ = file;
  if (!poses_file_.empty()) poses_ = read_camera_poses(poses_file_);
  if (!options_.scene.empty()) start(options_.scene);
}

void TrackingInput::start(const std::string& scene) {
  if (scene == scene_) return;
  tracking_ = std::make_unique<MarkerTracking>(options_.tracking, settings_, markers_of(scene));
  scene_ = scene;
  tracking_->set_poses(poses_);
  for (const auto& [camera, info] : infos_) tracking_->add_info(camera, info);
}

void TrackingInput::set_poses(const std::vector<CameraPose>& poses) {
  poses_ = poses;
  poses_file_ = options_.poses;
  if (tracking_) tracking_->set_poses(poses_);
}

void TrackingInput::set_settings(const TrackerSettings& settings) {
  settings_ = settings;
  if (tracking_) tracking_->set_settings(settings);
}

void TrackingInput::add_info(const std::string& camera, const sensor_msgs::CameraInfo& info) {
  camera_model(info);  // refuses a wrong one, also before there is a scene
  if (tracking_) tracking_->add_info(camera, info);
  infos_[camera] = info;
}

void TrackingInput::add_simulated(const MarkerObservations& message) {
  if (tracking_ && options_.use_simulated) tracking_->add_simulated(message);
}

void TrackingInput::add_frame(const RgbdFrame& frame) {
  if (!tracking_) return;
  for (const auto& result : tracking_->add(frame)) on_result_(result);
}

void TrackingInput::finish() {
  if (!tracking_) return;
  for (const auto& result : tracking_->finish()) on_result_(result);
}

std::string TrackingInput::missing(const std::string& camera) const {
  const bool stands =
      std::any_of(poses_.begin(), poses_.end(), [&](const CameraPose& pose) { return pose.name == camera; });
  if (!stands)
    return "where it stands is not known: " + (poses_file_.empty() ? options_.poses : poses_file_) +
           " does not name it; calibrate the cameras";
  if (infos_.count(camera) == 0) return "its lens is not known: nothing usable came on " + info_topic(camera);
  return {};
}

}  // namespace soft_robot_lab
