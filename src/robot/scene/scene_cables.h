// SPDX-License-Identifier: BSD-3-Clause
// The cables that a scene file lists, and YAML that gives them other numbers.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace soft_robot_lab {

class SceneCables {
 public:
  // `changes`: as SceneOptions::changes. Throws SettingsError.
  SceneCables(const std::string& scene_path, const std::string& overrides);

  const std::vector<std::string>& names() const { return names_; }
  std::optional<std::string> value(const std::string& cable, const std::string& key) const;  // as YAML
  // Throws std::invalid_argument listing the names.
  void set(const std::string& cable, const std::string& key, const std::string& value);
  // To be laid over the file: all that differs from it, also by the changes; empty where nothing does.
  std::string yaml() const;

 private:
  using Entries = std::map<std::string, std::map<std::string, std::string>>;  // by cable and key

  static Entries read(const std::string& scene_path, const std::string& overrides, std::vector<std::string>& names);

  std::vector<std::string> names_;
  Entries in_file_, now_;
};

}  // namespace soft_robot_lab
