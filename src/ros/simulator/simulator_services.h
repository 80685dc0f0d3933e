// SPDX-License-Identifier: BSD-3-Clause
// Requests to a simulation, answered beside its steps. Handlers run in threads of their own.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <soft_robot_lab/LoadScene.h>
#include <soft_robot_lab/UseSolver.h>
#include <std_srvs/Trigger.h>

#include "ros/base/node_diagnosis.h"

namespace soft_robot_lab {

class SimulatorServices {
 public:
  using Trigger = std::function<void(std_srvs::Trigger::Response&)>;
  // Returns what is said of its success. Throws std::exception where it refuses.
  template <typename Service>
  using Change = std::function<std::string(const typename Service::Request&)>;

  SimulatorServices() = default;
  ~SimulatorServices();
  SimulatorServices(const SimulatorServices&) = delete;
  SimulatorServices& operator=(const SimulatorServices&) = delete;

  // What has to be answered while a step is solved, which may last; and a diagnosis each second.
  void serve_control(Trigger reset, Trigger stop, std::function<void(NodeDiagnosis::Status&)> diagnose);
  // What takes seconds, one at a time; meanwhile the old scene goes on.
  void serve_changes(Change<LoadScene> load, Change<UseSolver> use_solver);

 private:
  ros::ServiceServer trigger(const std::string& name, Trigger handler);
  template <typename Service>
  ros::ServiceServer change(const std::string& name, Change<Service> handler);

  ros::NodeHandle node_;
  ros::CallbackQueue control_queue_, changes_queue_;
  NodeDiagnosis diagnosis_{"simulated"};
  std::vector<ros::ServiceServer> servers_;
  ros::AsyncSpinner control_{2, &control_queue_}, changes_{1, &changes_queue_};  // the diagnosis waits too
};

}  // namespace soft_robot_lab
