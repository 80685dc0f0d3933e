// SPDX-License-Identifier: BSD-3-Clause
// The check of a parameter that comes by name, not from a file's line.
#pragma once

#include <stdexcept>
#include <string>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// Throws std::invalid_argument: "surface_rate_hz: 0.000000 is not in (0, 1000]".
template <class Number>
void require_in_range(const std::string& name, Number value, const AllowedRange& range) {
  if (range.contains(value)) return;
  throw std::invalid_argument(name + ": " + std::to_string(value) + " is not in " + range.to_string());
}

}  // namespace soft_robot_lab
