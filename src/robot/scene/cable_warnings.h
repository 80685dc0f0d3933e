// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/embedding.h"
#include "soft_robot_lab/mechanics/solve_report.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// Cables that are simulated as they stand, and are seldom meant so. A warning each, with what to do:
// - `straight_in_silicone`: between two `points_m` a cable is straight. Where silicone lies all along such a span of
//   more than three elements the body bends around it and the cable does not. Its longest span is named; none where
//   `via_points: given` says that it is meant.
// - `plug_on_skin`: a path_m or spline_m ends on the skin. Silicone snaps over the plug there: steps in time are slow.
// - `cable_back_to_front`: it ends where the body is held and starts far from there, as if the drive sat at the tip.
std::vector<SolveWarning> cable_warnings(const YamlNode& scene, const Body& body, const MeshLocator& locator);

}  // namespace soft_robot_lab
