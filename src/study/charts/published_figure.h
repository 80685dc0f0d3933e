// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// Published by others, and not run here.
struct PublishedFigure {
  std::string name;
  std::optional<double> unknowns;  // where they are stated
  double times_real_time = 0.0;
  std::string published;  // the figure in its own words and units
  std::string setting;    // how it differs from what runs here
  std::string source;
};

std::vector<PublishedFigure> read_published(const std::vector<YamlNode>& list);

}  // namespace soft_robot_lab
