// SPDX-License-Identifier: BSD-3-Clause
#include "camera_driver.h"

#include <algorithm>
#include <stdexcept>

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/topic.h>

namespace soft_robot_lab {
namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigDescription;

constexpr char automatic[] = "enable_auto_exposure", exposure[] = "exposure", gain[] = "gain";

void add(const char* name, int value, Config& config) {
  dynamic_reconfigure::IntParameter parameter;
  parameter.name = name;
  parameter.value = value;
  config.ints.push_back(parameter);
}

void add(const char* name, bool value, Config& config) {
  dynamic_reconfigure::BoolParameter parameter;
  parameter.name = name;
  parameter.value = value;
  config.bools.push_back(parameter);
}

template <typename Parameters>
auto find(const Parameters& parameters, const char* name) {
  return std::find_if(parameters.begin(), parameters.end(), [&](const auto& each) { return each.name == name; });
}

// Throws where there is none.
template <typename Parameters>
auto value_of(const Parameters& parameters, const char* name) {
  const auto found = find(parameters, name);
  if (found != parameters.end()) return found->value;
  std::string known;
  for (const auto& each : parameters) known += (known.empty() ? "" : ", ") + each.name;
  throw std::invalid_argument("the camera's driver has no parameter '" + std::string(name) + "' of its type, only " +
                              (known.empty() ? "none" : known) + "; realsense2_camera of ROS 1 has it");
}

Config bounds(int exposure_bound, int gain_bound, bool automatic_bound) {
  return config_message({automatic_bound, exposure_bound, gain_bound});
}

dynamic_reconfigure::ParamDescription describe(const char* name, const char* type, const char* what) {
  dynamic_reconfigure::ParamDescription description;
  description.name = name;
  description.type = type;
  description.description = what;
  return description;
}

void require_taken(const char* name, int wanted, int taken) {
  if (wanted != taken)
    throw std::runtime_error(std::string(name) + ": the camera's driver was asked for " + std::to_string(wanted) +
                             " and has " + std::to_string(taken));
}

}  // namespace

std::string set_parameters_service(const std::string& camera) { return camera + "/rgb_camera/set_parameters"; }
std::string parameter_descriptions_topic(const std::string& camera) {
  return camera + "/rgb_camera/parameter_descriptions";
}
std::string parameter_updates_topic(const std::string& camera) { return camera + "/rgb_camera/parameter_updates"; }

Config config_message(const CameraSetting& setting) {
  Config config;
  add(automatic, setting.automatic, config);
  add(exposure, setting.exposure, config);
  add(gain, setting.gain, config);
  return config;
}

ConfigDescription description_message(const CameraSettingLimits& limits, const CameraSetting& own_setting) {
  ConfigDescription description;
  dynamic_reconfigure::Group group;
  group.name = "Default";
  group.parameters = {describe(automatic, "bool", "the camera's own exposure and gain"),
                      describe(exposure, "int", "in units of 0.1 ms"), describe(gain, "int", "of the colour sensor")};
  description.groups = {group};
  description.min = bounds(limits.min_exposure, limits.min_gain, false);
  description.max = bounds(limits.max_exposure, limits.max_gain, true);
  description.dflt = config_message(own_setting);
  return description;
}

CameraSetting camera_setting(const Config& config) {
  return {value_of(config.bools, automatic) != 0, value_of(config.ints, exposure), value_of(config.ints, gain)};
}

CameraSettingLimits camera_setting_limits(const ConfigDescription& description) {
  return {value_of(description.min.ints, exposure), value_of(description.max.ints, exposure),
          value_of(description.min.ints, gain), value_of(description.max.ints, gain)};
}

CameraSetting with_request(CameraSetting setting, const Config& request, const CameraSettingLimits& limits) {
  if (const auto found = find(request.bools, automatic); found != request.bools.end())
    setting.automatic = found->value != 0;
  if (const auto found = find(request.ints, exposure); found != request.ints.end())
    setting.exposure = std::clamp(found->value, limits.min_exposure, limits.max_exposure);
  if (const auto found = find(request.ints, gain); found != request.ints.end())
    setting.gain = std::clamp(found->value, limits.min_gain, limits.max_gain);
  return setting;
}

CameraDriver::CameraDriver(ros::NodeHandle& node, const std::string& camera, double timeout_s) {
  const std::string name = node.resolveName(set_parameters_service(camera));
  const ros::SteadyTime limit = ros::SteadyTime::now() + ros::WallDuration(timeout_s);
  while (!ros::service::exists(name, false)) {
    if (!ros::ok() || ros::SteadyTime::now() > limit)
      throw std::runtime_error("there is no service " + name + "; start the camera's driver, or name another camera");
    ros::WallDuration(0.1).sleep();
  }
  service_ = node.serviceClient<dynamic_reconfigure::Reconfigure>(name);
  boost::shared_ptr<const ConfigDescription> described;
  const ros::Subscriber descriptions = node.subscribe<ConfigDescription>(
      parameter_descriptions_topic(camera), 1,
      boost::function<void(const ConfigDescription::ConstPtr&)>([&](const auto& message) { described = message; }));
  while (!described) {
    if (!ros::ok() || ros::SteadyTime::now() > limit)
      throw std::runtime_error("nothing comes on " + descriptions.getTopic() + "; is that driver realsense2_camera?");
    ros::spinOnce();
    ros::WallDuration(0.02).sleep();
  }
  limits_ = camera_setting_limits(*described);
}

Config CameraDriver::request(const Config& config) {
  dynamic_reconfigure::Reconfigure exchange;
  exchange.request.config = config;
  if (!service_.call(exchange)) throw std::runtime_error(service_.getService() + ": no answer");
  return exchange.response.config;
}

CameraSetting CameraDriver::setting() { return camera_setting(request({})); }

void CameraDriver::set(const CameraSetting& setting) {
  // By itself first: while a camera exposes automatically its driver may leave the other two alone.
  Config mode;
  add(automatic, setting.automatic, mode);
  CameraSetting taken = camera_setting(request(mode));
  if (!setting.automatic) taken = camera_setting(request(config_message(setting)));
  require_taken(automatic, setting.automatic, taken.automatic);
  if (setting.automatic) return;
  require_taken(exposure, setting.exposure, taken.exposure);
  require_taken(gain, setting.gain, taken.gain);
}

}  // namespace soft_robot_lab
