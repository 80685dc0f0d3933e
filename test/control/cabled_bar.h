// SPDX-License-Identifier: BSD-3-Clause
// A bar of 100 x 20 x 20 mm, held at x = 0, with a cable on either side.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mechanics/box_mesh.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

inline std::unique_ptr<Actuator> cable(const std::string& name, double y_m, const Body& body,
                                       const MeshLocator& locator) {
  const std::string y = std::to_string(y_m);
  auto actuator = make_actuator("soft_robot_lab/Cable");
  actuator->initialise(
      YamlNode::parse("{name: " + name + ", points_m: [[0, " + y + ", 0], [0.1, " + y + ", 0]]}", "test"), body,
      locator);
  return actuator;
}

inline Simulation bar(SolverOptions options = {}, double youngs_modulus_pa = 264200.0,
                      const Eigen::Vector3d& gravity_m_s2 = Eigen::Vector3d::Zero()) {
  Body body(box_mesh({0, -0.01, -0.01}, {0.1, 0.01, 0.01}, {5, 2, 1}), Material{youngs_modulus_pa, 0.499, 1070.0});
  body.fix_nodes({-1, -1, -1}, {1e-6, 1, 1}, {true, true, true});
  body.set_gravity(gravity_m_s2);
  const MeshLocator locator(body.mesh());
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(cable("left", -0.007, body, locator));
  actuators.push_back(cable("right", 0.007, body, locator));
  std::vector<Marker> markers;
  markers.emplace_back("middle", Eigen::Vector3d(0.05, 0.0, 0.0), body.mesh(), locator);
  markers.emplace_back("tip", Eigen::Vector3d(0.1, 0.0, 0.0), body.mesh(), locator);
  return Simulation(std::move(body), std::move(actuators), std::move(markers), options);
}

}  // namespace soft_robot_lab
