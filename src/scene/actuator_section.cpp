#include "scene/sections.h"

namespace soft_robot_lab {
namespace {

std::unique_ptr<Actuator> make(const ActuatorFactory& factory, const std::string& plugin, const SettingsNode& place) {
  if (!factory) place.fail("no actuators can be made here: '" + plugin + "'");
  return in_section(place, [&] { return factory(plugin); });
}

}  // namespace

// Commands, results and sensitivities follow this order: cables, chambers, then the general list.
std::vector<std::unique_ptr<Actuator>> read_actuators(const SettingsNode& scene, const Body& body,
                                                      const MeshLocator& locator, const ActuatorFactory& factory) {
  std::vector<std::unique_ptr<Actuator>> actuators;
  const auto add = [&](std::unique_ptr<Actuator> actuator, const SettingsNode& node) {
    in_section(node, [&] { actuator->initialise(node, body, locator); });
    actuators.push_back(std::move(actuator));
  };
  for (const SettingsNode& node : scene.optional_sequence("cables")) {
    add(make(factory, "soft_robot_lab/Cable", node), node);
  }
  for (const SettingsNode& node : scene.optional_sequence("chambers")) {
    add(make(factory, "soft_robot_lab/Chamber", node), node);
  }
  for (const SettingsNode& node : scene.optional_sequence("actuators")) {
    add(make(factory, node.text("plugin"), node.child("plugin")), node);
  }
  return actuators;
}

std::vector<Marker> read_markers(const SettingsNode& scene, const Body& body, const MeshLocator& locator) {
  std::vector<Marker> markers;
  for (const SettingsNode& node : scene.optional_sequence("markers")) {
    markers.push_back(
        in_section(node, [&] { return Marker(node.text("name"), node.vector3("position_m"), body.mesh(), locator); }));
  }
  return markers;
}

}  // namespace soft_robot_lab
