// SPDX-License-Identifier: BSD-3-Clause
// The cables that a scene file lists.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "soft_robot_lab/settings/overrides.h"

namespace soft_robot_lab {

class SceneCables {
 public:
  // Throws SettingsError.
  SceneCables(const std::string& scene_path, const Overrides& overrides);

  const std::vector<std::string>& names() const { return names_; }
  // Nothing where the scene does not say it.
  std::optional<YamlNode> value(const std::string& cable, const std::string& key) const;
  // Throws std::invalid_argument listing the names.
  void require_known(const std::string& cable) const;

 private:
  std::vector<std::string> names_;
  std::vector<YamlNode> cables_;  // in the order of the names
};

}  // namespace soft_robot_lab
