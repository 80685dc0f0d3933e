#include "soft_robot_lab/ros/calibrate_request.h"

#include <exception>

#include "soft_robot_lab/ros/topics.h"

namespace soft_robot_lab {
namespace {

geometry_msgs::Quaternion to_quaternion(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond turn(pose.linear());
  geometry_msgs::Quaternion message;
  message.x = turn.x();
  message.y = turn.y();
  message.z = turn.z();
  message.w = turn.w();
  return message;
}

void fill(const std::vector<CameraPose>& poses, Calibrate::Response& answer) {
  for (const CameraPose& pose : poses) {
    geometry_msgs::Pose message;
    message.position.x = pose.world_from_camera.translation().x();
    message.position.y = pose.world_from_camera.translation().y();
    message.position.z = pose.world_from_camera.translation().z();
    message.orientation = to_quaternion(pose.world_from_camera);
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
    answer.message = error.what();
  }
  return poses;
}

geometry_msgs::TransformStamped to_transform(const CameraPose& pose, const ros::Time& stamp) {
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = stamp;
  transform.header.frame_id = topics::world_frame;
  transform.child_frame_id = pose.name + "_color_optical_frame";
  transform.transform.translation.x = pose.world_from_camera.translation().x();
  transform.transform.translation.y = pose.world_from_camera.translation().y();
  transform.transform.translation.z = pose.world_from_camera.translation().z();
  transform.transform.rotation = to_quaternion(pose.world_from_camera);
  return transform;
}

}  // namespace soft_robot_lab
