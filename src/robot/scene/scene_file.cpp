// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/robot/scene/scene_file.h"

#include <set>

#include "sections.h"

namespace soft_robot_lab {

bool is_scene_file(const std::string& path) {
  static const std::set<std::string> known = {"actuators", "body",       "cables",       "casting", "chambers",
                                              "contact",   "fidelity",   "gravity_m_s2", "include", "loads",
                                              "markers",   "parameters", "run",          "solver"};
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

}  // namespace soft_robot_lab
