// SPDX-License-Identifier: BSD-3-Clause
#include "scene_cables.h"

#include <algorithm>
#include <stdexcept>

#include "sections.h"
#include "settings/words.h"

namespace soft_robot_lab {

SceneCables::SceneCables(const std::string& scene_path, const Overrides& overrides)
    : cables_(with_overrides(YamlNode::load_file(scene_path), overrides).optional_sequence("cables")) {
  for (const YamlNode& cable : cables_) names_.push_back(cable.text("name"));
}

std::optional<YamlNode> SceneCables::value(const std::string& cable, const std::string& key) const {
  const auto found = std::find(names_.begin(), names_.end(), cable);
  return found == names_.end() ? std::nullopt
                               : cables_[static_cast<std::size_t>(found - names_.begin())].optional_child(key);
}

void SceneCables::require_known(const std::string& cable) const {
  if (std::find(names_.begin(), names_.end(), cable) != names_.end()) return;
  throw std::invalid_argument("unknown cable '" + cable + "'; known: " + (names_.empty() ? "none" : join(names_)));
}

}  // namespace soft_robot_lab
