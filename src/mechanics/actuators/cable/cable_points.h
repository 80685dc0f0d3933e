// SPDX-License-Identifier: BSD-3-Clause
// Where a cable's points take hold of the body.
#pragma once

#include <vector>

#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/actuator.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

struct CablePoints {
  std::vector<EmbeddedPoint> points;
  std::vector<PathChange> changes;
};

// Reads drive_points_m, the path (points_m, path_m or spline_m), via_points, sheath_radius_m, plug_radius_m and
// spread_box_m. Points just outside the body are moved onto it; each is spread over sheath, plug or box, except on held
// material. Throws SettingsError with the place.
CablePoints read_cable_points(const YamlNode& settings, const Body& body, const MeshLocator& locator);

}  // namespace soft_robot_lab
