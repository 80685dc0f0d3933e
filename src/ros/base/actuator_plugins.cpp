// SPDX-License-Identifier: BSD-3-Clause
#include "actuator_plugins.h"

#include <memory>
#include <stdexcept>

#include <pluginlib/class_loader.hpp>

#include "soft_robot_lab/mechanics/actuator.h"

namespace soft_robot_lab {
namespace {

using Loader = pluginlib::ClassLoader<Actuator>;

std::string declared_names(Loader& loader) {
  std::string names;
  for (const std::string& name : loader.getDeclaredClasses()) names += (names.empty() ? "" : ", ") + name;
  return names;
}

std::unique_ptr<Actuator> make(Loader& loader, const std::string& plugin) {
  if (!loader.isClassAvailable(plugin)) {
    throw std::invalid_argument("actuator plugin '" + plugin + "' is not one of " + declared_names(loader));
  }
  try {
    return std::unique_ptr<Actuator>(loader.createUnmanagedInstance(plugin));
  } catch (const pluginlib::PluginlibException& error) {
    throw std::invalid_argument("actuator plugin '" + plugin + "' does not load: " + error.what());
  }
}

}  // namespace

ActuatorFactory actuators_from_plugins() {
  const auto loader = std::make_shared<Loader>("soft_robot_lab", "soft_robot_lab::Actuator");
  return [loader](const std::string& plugin) { return make(*loader, plugin); };
}

}  // namespace soft_robot_lab
