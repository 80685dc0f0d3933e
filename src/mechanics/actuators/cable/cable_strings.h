// SPDX-License-Identifier: BSD-3-Clause
// Which spans of a cable find their way around obstacles.
#pragma once

#include <vector>

#include "path_length.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// Reads `around`. Every span that is mostly in the air at rest gets a string, on the side of each obstacle on which the
// span passes at rest, or on which `by_m` lies. Empty without that key. Throws SettingsError: no such obstacle, one
// that moves or is a plane, a point inside one, and a cable that is nowhere in the air.
std::vector<SpanString> read_strings(const YamlNode& settings, const Body& body, const MeshLocator& locator,
                                     const std::vector<EmbeddedPoint>& points);

}  // namespace soft_robot_lab
