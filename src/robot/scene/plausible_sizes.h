// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/marker.h"
#include "soft_robot_lab/mechanics/solve_report.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// Sizes that a robot cast by hand does not have, because somebody wrote millimetres or megapascals: of the body
// (`implausible_size`), its modulus (`implausible_stiffness`), density (`implausible_density`), gravity
// (`implausible_gravity`), a marker's stalk
// (`implausible_stalk`). They are simulated all the same. None of a modulus beside a `stiffness_ratio`.
std::vector<SolveWarning> implausible_sizes(const YamlNode& scene, const Body& body, const MeshLocator& locator,
                                            const std::vector<Marker>& markers);

// No solid has a modulus below 20 Pa: megapascals were meant, and every motion would outrun such a body. Throws
// SettingsError: key, value, usual range, what was rather meant. A `stiffness_ratio` beside the modulus lifts it.
void refuse_megapascals(const YamlNode& scene);

// Where an odd modulus, gravity or size lets weight, loads and the run's commands strain the body by more than 2, as
// solving for that takes long and no robot is meant. They are compared with Young's modulus: a column as high as the
// body; forces over the largest side of the box around it; commanded pressures. Throws as above, and is lifted
// likewise.
void refuse_unbearable(const YamlNode& scene, const Simulation& simulation, const RunSettings& run);

}  // namespace soft_robot_lab
