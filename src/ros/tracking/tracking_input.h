// SPDX-License-Identifier: BSD-3-Clause
// Images of cameras become pairs, pairs become groups, groups become markers: in a session and from a recording alike.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <message_filters/time_synchronizer.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include "marker_tracking.h"

namespace soft_robot_lab {

std::string colour_topic(const std::string& camera);
std::string depth_topic(const std::string& camera);
std::string info_topic(const std::string& camera);  // of the colour camera, with which depth is aligned

using ImagePair = message_filters::TimeSynchronizer<sensor_msgs::Image, sensor_msgs::Image>;
constexpr int waiting_images = 10;

struct TrackingInputOptions {
  TrackingOptions tracking;
  std::string tracker;        // path of the tracker's settings
  std::string poses;          // path: where the cameras stand; a calibration writes it
  std::string default_poses;  // path, read while there is no such file; may be empty
  std::string scene;          // path; empty: somebody will say start()
  bool use_simulated = true;  // simulated markers say where to look first
};

class TrackingInput {
 public:
  using OnResult = std::function<void(const MarkerTracking::Result&)>;

  // Throws SettingsError and std::invalid_argument for files that are wrong.
  TrackingInput(TrackingInputOptions options, OnResult on_result);

  void start(const std::string& scene);
  void set_poses(const std::vector<CameraPose>& poses);
  void set_settings(const TrackerSettings& settings);
  void add_info(const std::string& camera, const sensor_msgs::CameraInfo& info);
  void add_simulated(const MarkerObservations& message);
  void add_frame(const RgbdFrame& frame);
  void finish();

  const MarkerTracking* tracking() const { return tracking_.get(); }  // null before a scene
  const std::vector<CameraPose>& poses() const { return poses_; }
  const std::string& poses_file() const { return poses_file_; }      // that they were read from; may be empty
  bool calibrated() const { return poses_file_ == options_.poses; }  // else they are where they are meant to stand
  const TrackerSettings& settings() const { return settings_; }
  // What is not known yet of a camera whose images come, or nothing.
  std::string missing(const std::string& camera) const;

 private:
  TrackingInputOptions options_;
  TrackerSettings settings_;
  OnResult on_result_;
  std::vector<CameraPose> poses_;
  std::string poses_file_;
  std::map<std::string, sensor_msgs::CameraInfo> infos_;
  std::string scene_;
  std::unique_ptr<MarkerTracking> tracking_;
};

}  // namespace soft_robot_lab
