// SPDX-License-Identifier: BSD-3-Clause
// What a node says of itself on `/diagnostics`, each second of the machine, whatever the session's clock does.
#pragma once

#include <functional>
#include <string>

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

namespace soft_robot_lab {

class NodeDiagnosis {
 public:
  using Status = diagnostic_updater::DiagnosticStatusWrapper;
  static constexpr double period_s = 1.0;

  explicit NodeDiagnosis(const std::string& hardware) { updater_.setHardwareID(hardware); }

  void add(const std::string& name, std::function<void(Status&)> diagnose) { updater_.add(name, std::move(diagnose)); }
  // All of them are called in threads that serve `queue`; null: the node's own.
  void start(ros::CallbackQueueInterface* queue = nullptr) {
    ros::SteadyTimerOptions every_second(
        ros::WallDuration(period_s), [this](const auto&) { updater_.force_update(); }, queue);
    timer_ = ros::NodeHandle().createSteadyTimer(every_second);
  }

 private:
  diagnostic_updater::Updater updater_;
  ros::SteadyTimer timer_;
};

}  // namespace soft_robot_lab
