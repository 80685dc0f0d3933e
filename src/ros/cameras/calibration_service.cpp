// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_service.h"

#include <utility>

#include "ros/base/log_text.h"
#include "ros/base/topics.h"
#include "ros/cameras/calibrate_request.h"
#include "ros/messages/same_fields.h"

namespace soft_robot_lab {

CalibrationService::CalibrationService(ros::NodeHandle& node, const std::string& balls, std::string poses, Found found)
    : session_(read_ball_placement(balls), BallFinderSettings()),
      poses_(std::move(poses)),
      found_(std::move(found)),
      action_(node, topics::calibrate, false) {
  server_ = node.advertiseService(topics::calibrate, &CalibrationService::answer, this);
  action_.registerGoalCallback([this] { on_goal(); });
  action_.start();
}

bool CalibrationService::answer(Calibrate::Request& request, Calibrate::Response& response) {
  const std::vector<CameraPose> found = calibrate(request, session_, poses_, response);
  if (!found.empty()) found_(found);
  if (!response.success) ROS_WARN("%s refused: %s", topics::calibrate, log_text(response.message).c_str());
  return true;
}

void CalibrationService::on_goal() {
  auto request = same_fields<Calibrate::Request>(*action_.acceptNewGoal());
  Calibrate::Response response;
  answer(request, response);
  const auto result = same_fields<CalibrateResult>(response);
  if (result.success)
    action_.setSucceeded(result, result.message);
  else
    action_.setAborted(result, result.message);
}

}  // namespace soft_robot_lab
