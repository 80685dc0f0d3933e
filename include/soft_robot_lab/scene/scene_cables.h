// The cables that a scene file lists, and YAML that gives them other numbers: lists replace each other as a whole
// (scene.h), so a change of one number has to repeat all of them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace soft_robot_lab {

class SceneCables {
 public:
  // `changes`: as SceneOptions::changes. Throws SettingsError.
  SceneCables(const std::string& scene_path, const std::string& changes);

  std::vector<std::string> names() const;
  std::optional<std::string> value(const std::string& cable, const std::string& key) const;  // a scalar
  // Throws std::invalid_argument listing the names.
  void set(const std::string& cable, const std::string& key, const std::string& value);
  std::string yaml() const;  // "cables: [...]" with what was set; empty where nothing was

 private:
  using Entry = std::pair<std::string, std::string>;  // key, its value as YAML
  struct Cable {
    std::string name;
    std::vector<Entry> entries;
  };
  Cable& find(const std::string& cable);

  std::vector<Cable> cables_;
  bool changed_ = false;
};

}  // namespace soft_robot_lab
