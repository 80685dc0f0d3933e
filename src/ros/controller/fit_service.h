// SPDX-License-Identifier: BSD-3-Clause
// The service controller/fit_model, and the recording of the running session that it fits to.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <string>

#include <ros/ros.h>
#include <soft_robot_lab/FitModel.h>
#include <std_msgs/String.h>

#include "ros/messages/messages.h"
#include "session/recording.h"
#include "soft_robot_lab/control/identification/fit_model.h"

namespace soft_robot_lab {

// Throws std::invalid_argument for lists of different lengths.
FitRequest fit_request(const FitModel::Request& request);
void fill_response(const FitResult& result, FitModel::Response& response);

class FitService {
 public:
  // A fit keeps one of the node's threads for seconds to minutes. `scene`: its path until the simulator names another;
  // may be empty.
  FitService(ros::NodeHandle& node, SceneOptions options, const std::string& scene);

  void answer(const FitModel::Request& request, FitModel::Response& response);
  void cancel() { cancelled_ = true; }  // the fit that runs: it ends with the best so far
  // Hears of each iteration, from the fit's thread; to be set before there are requests.
  std::function<void(int iteration, double rms_gap_m)> on_progress;

 private:
  void on_command(const ActuatorCommand& command);
  void on_motors(const MotorState& motors);
  void on_markers(const MarkerObservations& markers);
  void on_scene(const std_msgs::String& path);
  Recording heard() const;

  SceneOptions options_;
  std::mutex fitting_;
  std::atomic<bool> cancelled_{false};
  mutable std::mutex mutex_;  // guards the recording
  Recording recording_;
  std::vector<ros::Subscriber> subscribers_;
  ros::ServiceServer service_;
};

}  // namespace soft_robot_lab
