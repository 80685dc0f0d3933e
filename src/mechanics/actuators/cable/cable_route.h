// SPDX-License-Identifier: BSD-3-Clause
// Through which points a cable runs: those given, and those that mesh and skin set between them.
#pragma once

#include <optional>
#include <vector>

#include "mechanics/mesh/cable_path.h"
#include "mechanics/mesh/skin.h"
#include "soft_robot_lab/mechanics/embedding.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

inline constexpr double kNear_m = 1e-9;  // points this near are one

struct PathPoint {
  Eigen::Vector3d position_m;
  int given;  // its place among the given ones; -1 for one set between them
  // Of the disc over which the sheath spreads it: the skin's where the sheath has its mouth; without a value the
  // path's.
  std::optional<Eigen::Vector3d> normal = std::nullopt;
};

using GivenPath = std::vector<Eigen::Vector3d>;

std::vector<PathPoint> as_given(const GivenPath& path);

// One more point in every element that the cable crosses and that holds none, in the middle of its way through it
// (about what the source's 4.2.1 asks for).
std::vector<PathPoint> with_point_per_element(const GivenPath& path, const TetMesh& mesh, const MeshLocator& locator);

// One more point wherever the path leaves or enters the body.
struct RouteRules {
  // Depth below or height above the skin that counts as on it. A stretch of the path that goes no deeper, or no
  // farther out, belongs to what surrounds it, where it is shorter than 20 times this; a longer one is refused: it runs
  // along the skin, neither in a sheath nor free.
  double tolerance_m;
  bool per_element;  // and points inside, as above
};

// Throws SettingsError at a point in the air, and at a leg along the skin.
std::vector<PathPoint> routed(const CablePath& path, const TetMesh& mesh, const MeshLocator& locator,
                              const RouteRules& rules, const YamlNode& settings);

}  // namespace soft_robot_lab
