// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate_request.h"

#include <exception>

#include "ros/base/log_text.h"
#include "ros/messages/conversions.h"

namespace soft_robot_lab {
namespace {

void fill(const std::vector<CameraPose>& poses, Calibrate::Response& answer) {
  for (const CameraPose& pose : poses) {
    geometry_msgs::Pose message;
    message.position = to_message(pose.world_from_camera.translation());
    message.orientation = to_message(Eigen::Quaterniond(pose.world_from_camera.linear()));
    answer.cameras.push_back(pose.name);
    answer.poses.push_back(message);
    answer.residuals_m.push_back(pose.residual_m.value_or(0));
  }
}

}  // namespace

std::vector<CameraPose> calibrate(const Calibrate::Request& request, CalibrationSession& session,
                                  const std::string& file, Calibrate::Response& answer) {
  answer = {};
  std::vector<CameraPose> poses;
  try {
    if (request.with_balls) {
      for (const CameraCalibration& calibration : session.calibrate()) poses.push_back(calibration.pose);
      write_camera_poses(file, poses);
      fill(poses, answer);
      answer.message = "saved to " + file;
    } else {
      session.remember_without_balls();
      answer.message = "remembered the scene without balls; now put them into their places and call with_balls";
    }
    answer.success = true;
  } catch (const std::exception& error) {
    poses.clear();
    answer.message = answer_text(error);
  }
  return poses;
}

}  // namespace soft_robot_lab
