// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "soft_robot_lab/settings/overrides.h"

namespace soft_robot_lab {

// As a user would write them; empty for none.
inline Overrides overrides_from(const std::string& yaml) {
  return yaml.empty() ? Overrides() : Overrides(YamlNode::parse(yaml, "test"));
}

}  // namespace soft_robot_lab
