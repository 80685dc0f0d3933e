// SPDX-License-Identifier: BSD-3-Clause
// A tracker's numbers, changed while it runs, as by dynamic_reconfigure's own servers: what is out of range is cut, and
// the answer is what holds now.
#pragma once

#include <functional>

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/ros.h>

#include "soft_robot_lab/perception/tracking/tracker_settings.h"

namespace soft_robot_lab {

class TrackerParameterServer {
 public:
  using Change = std::function<void(const TrackerSettings& settings)>;

  // Under the node's own name.
  TrackerParameterServer(const TrackerSettings& settings, Change change);

 private:
  bool answer(dynamic_reconfigure::Reconfigure::Request& request, dynamic_reconfigure::Reconfigure::Response& response);
  void publish() const;

  TrackerSettings settings_;
  Change change_;
  ros::NodeHandle node_{"~"};
  ros::Publisher descriptions_, updates_;
  ros::ServiceServer server_;
};

}  // namespace soft_robot_lab
