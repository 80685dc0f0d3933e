// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/robot/scene/scene_file.h"

#include <filesystem>
#include <set>

#include "sections.h"
#include "settings/named_file.h"

namespace soft_robot_lab {

bool is_scene_file(const std::string& path) {
  static const std::set<std::string> known = {
      "actuators", "bodies",       "body",    "cables", "casting", "chambers",   "contact", "fibres",
      "fidelity",  "gravity_m_s2", "include", "loads",  "markers", "parameters", "run",     "solver"};
  try {
    const YamlNode scene = with_includes(YamlNode::load_file(path));
    if (!scene.is_map() || !scene.has("body")) return false;
    for (const std::string& key : scene.keys())
      if (known.count(key) == 0) return false;
    return scene.child("body").is_map();
  } catch (const SettingsError&) {
    return false;
  }
}

// What cannot be read is said by those that load it; a circle of files ends where it is met again.
std::string robot_file(const std::string& scene) {
  std::string file = std::filesystem::absolute(scene).lexically_normal().string();
  std::set<std::string> met;
  try {
    while (met.insert(file).second) {
      const std::optional<YamlNode> include = YamlNode::load_file(file).optional_child("include");
      if (!include) break;
      file = named_file(*include);
    }
  } catch (const SettingsError&) {
  }
  return file;
}

std::string name_of_robot(const std::string& scene) {
  const std::filesystem::path file = robot_file(scene);
  return (file.filename() == "robot.yaml" ? file.parent_path().filename() : file.stem()).string();
}

}  // namespace soft_robot_lab
