// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/marker.h"
#include "soft_robot_lab/mechanics/solve_report.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// Sizes that a robot cast by hand does not have, because somebody wrote millimetres or megapascals: of the body
// (`implausible_size`), its modulus (`implausible_stiffness`), gravity (`implausible_gravity`), a marker's stalk
// (`implausible_stalk`). They are simulated all the same. None of a modulus beside a `stiffness_ratio`.
std::vector<SolveWarning> implausible_sizes(const YamlNode& scene, const Body& body, const MeshLocator& locator,
                                            const std::vector<Marker>& markers);

}  // namespace soft_robot_lab
