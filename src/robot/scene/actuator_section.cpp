// SPDX-License-Identifier: BSD-3-Clause
#include "sections.h"
#include "settings/read_name.h"

namespace soft_robot_lab {
namespace {

std::unique_ptr<Actuator> make(const ActuatorFactory& factory, const std::string& plugin, const YamlNode& place) {
  if (!factory) place.fail("no actuators can be made here: '" + plugin + "'");
  return in_section(place, [&] { return factory(plugin); });
}

// A stalk turns with the body: a far longer one is a mistake, and its end shows nothing but rounding.
double longest_stalk_m(const Body& body) {
  const Eigen::Matrix3Xd& nodes_m = body.mesh().nodes_m;
  return 10.0 * (nodes_m.rowwise().maxCoeff() - nodes_m.rowwise().minCoeff()).norm();
}

}  // namespace

// Commands, results and sensitivities follow this order: cables, chambers, then the general list.
std::vector<std::unique_ptr<Actuator>> read_actuators(const YamlNode& scene, const Body& body,
                                                      const MeshLocator& locator, const ActuatorFactory& factory) {
  std::vector<std::unique_ptr<Actuator>> actuators;
  const auto add = [&](std::unique_ptr<Actuator> actuator, const YamlNode& node) {
    if (const std::optional<int> owner = read_owner(node, body.mesh())) {
      const MeshLocator in_owner(body.mesh(), owner);
      in_section(node, [&] { actuator->initialise(node, body, in_owner); });
    } else {
      in_section(node, [&] { actuator->initialise(node, body, locator); });
    }
    actuators.push_back(std::move(actuator));
  };
  for (const YamlNode& node : scene.optional_sequence("cables")) {
    add(make(factory, "soft_robot_lab/Cable", node), node);
  }
  for (const YamlNode& node : scene.optional_sequence("chambers")) {
    add(make(factory, "soft_robot_lab/Chamber", node), node);
  }
  for (const YamlNode& node : scene.optional_sequence("actuators")) {
    add(make(factory, node.text("plugin"), node.child("plugin")), node);
  }
  return actuators;
}

std::vector<Marker> read_markers(const YamlNode& scene, const Body& body, const MeshLocator& locator) {
  std::vector<Marker> markers;
  const double longest_m = longest_stalk_m(body);
  for (const YamlNode& node : scene.optional_sequence("markers")) {
    const Eigen::Vector3d position_m = node.vector3("position_m");
    const std::optional<int> owner = read_owner(node, body.mesh());
    const MeshLocator in_owner = owner ? MeshLocator(body.mesh(), owner) : locator;
    const double stalk_m = in_owner.locate(position_m).distance_m;
    if (!(stalk_m <= longest_m))
      node.child("position_m")
          .fail("lies " + std::to_string(stalk_m) + " m off the body, out of range [0, " + std::to_string(longest_m) +
                "]: ten times the body's size; its unit is the metre");
    markers.push_back(in_section(node, [&] { return Marker(read_name(node), position_m, body.mesh(), in_owner); }));
  }
  return markers;
}

}  // namespace soft_robot_lab
