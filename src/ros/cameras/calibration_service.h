// SPDX-License-Identifier: BSD-3-Clause
// The tracker's calibration as a service and as an action. Both are answered on the thread of the topics: images and
// calibration take turns.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <actionlib/server/simple_action_server.h>
#include <ros/ros.h>
#include <soft_robot_lab/Calibrate.h>
#include <soft_robot_lab/CalibrateAction.h>

#include "perception/calibration/calibration_session.h"

namespace soft_robot_lab {

class CalibrationService {
 public:
  using Found = std::function<void(const std::vector<CameraPose>& poses)>;

  // `balls`: the file of their places. `poses`: the file that the cameras' are saved to; `found` hears of them too.
  // Throws what read_ball_placement throws.
  CalibrationService(ros::NodeHandle& node, const std::string& balls, std::string poses, Found found);

  CalibrationSession& session() { return session_; }

 private:
  bool answer(Calibrate::Request& request, Calibrate::Response& response);
  void on_goal();

  CalibrationSession session_;
  std::string poses_;
  Found found_;
  ros::ServiceServer server_;
  actionlib::SimpleActionServer<CalibrateAction> action_;
};

}  // namespace soft_robot_lab
