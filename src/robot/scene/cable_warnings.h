// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/embedding.h"
#include "soft_robot_lab/mechanics/solve_report.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// A cable is straight between its `points_m`. Where silicone lies all along such a span, which is longer than three
// elements, the body bends around it and the cable does not (`straight_in_silicone`): one warning a cable, with its
// longest span. It is simulated all the same.
std::vector<SolveWarning> straight_cables(const YamlNode& scene, const Body& body, const MeshLocator& locator);

}  // namespace soft_robot_lab
