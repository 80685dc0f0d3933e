// SPDX-License-Identifier: BSD-3-Clause
// A clamped silicone bar with one cable, for tests of cable models.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mechanics/box_mesh.h"
#include "soft_robot_lab/mechanics/actuators/cable.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// 20 x 20 x 100 mm times `scale`, clamped at y = 0, hanging down, with a cable near the face x = 10 mm. Gravity goes
// down as lengths go up, so that one shape serves all.
inline Simulation hanging_bar(const std::string& cable_settings, const SolverOptions& options = {}, double scale = 1.0,
                              std::vector<Obstacle> obstacles = {}) {
  const double s = scale;
  Body body(box_mesh(s * Eigen::Vector3d(-0.01, -0.1, -0.01), s * Eigen::Vector3d(0.01, 0, 0.01), {2, 6, 2}),
            Material{264200.0, 0.49, 1070.0});
  body.fix_nodes({-10, -1e-6 * s, -10}, {10, 10, 10}, {true, true, true});
  body.set_gravity({0, -9.81 / s, 0});
  body.set_obstacles(std::move(obstacles));
  const MeshLocator locator(body.mesh());
  std::ostringstream settings;
  settings << "{name: cable, sheath_radius_m: " << 0.002 * s << ", plug_radius_m: " << 0.003 * s << ", points_m: [";
  for (const double y : {0.0, 0.02, 0.04, 0.06, 0.08, 0.095})
    settings << (y > 0 ? ", " : "") << "[" << 0.006 * s << ", " << -y * s << ", 0]";
  settings << "], " << cable_settings << "}";
  std::vector<std::unique_ptr<Actuator>> actuators;
  actuators.push_back(std::make_unique<Cable>());
  actuators.back()->initialise(YamlNode::parse(settings.str(), "bar"), body, locator);
  std::vector<Marker> markers;
  markers.emplace_back("tip", Eigen::Vector3d(0, -0.1 * s, 0), body.mesh(), locator);
  return Simulation(std::move(body), std::move(actuators), std::move(markers), options);
}

}  // namespace soft_robot_lab
