// SPDX-License-Identifier: BSD-3-Clause
// Exposure and gain of a camera through its driver's dynamic_reconfigure, as realsense2_camera has it: below
// CAMERA/rgb_camera the service set_parameters, and the latched topic parameter_descriptions.
#pragma once

#include <string>

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <ros/ros.h>

#include "perception/calibration/camera_setting.h"

namespace soft_robot_lab {

std::string set_parameters_service(const std::string& camera);
std::string parameter_descriptions_topic(const std::string& camera);
std::string parameter_updates_topic(const std::string& camera);

dynamic_reconfigure::Config config_message(const CameraSetting& setting);
dynamic_reconfigure::ConfigDescription description_message(const CameraSettingLimits& limits,
                                                           const CameraSetting& own_setting);
// What a driver answers. Throws std::invalid_argument: a parameter is missing, and which there are.
CameraSetting camera_setting(const dynamic_reconfigure::Config& config);
CameraSettingLimits camera_setting_limits(const dynamic_reconfigure::ConfigDescription& description);
// A setting with what a request names, each cut to its limits, as dynamic_reconfigure's servers do; other parameters
// are left out.
CameraSetting with_request(CameraSetting setting, const dynamic_reconfigure::Config& request,
                           const CameraSettingLimits& limits);

class CameraDriver {
 public:
  // Waits for the driver. Throws std::runtime_error: no service or no descriptions within `timeout_s`, and what to
  // do; std::invalid_argument: parameters that are missing.
  CameraDriver(ros::NodeHandle& node, const std::string& camera, double timeout_s);

  const CameraSettingLimits& limits() const { return limits_; }
  CameraSetting setting();
  // Throws std::runtime_error: no answer, or the driver took another value.
  void set(const CameraSetting& setting);

 private:
  dynamic_reconfigure::Config request(const dynamic_reconfigure::Config& config);

  ros::ServiceClient service_;
  CameraSettingLimits limits_;
};

}  // namespace soft_robot_lab
