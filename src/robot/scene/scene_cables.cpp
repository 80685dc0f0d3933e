// SPDX-License-Identifier: BSD-3-Clause
#include "scene_cables.h"

#include <stdexcept>

#include "sections.h"

namespace soft_robot_lab {

SceneCables::Entries SceneCables::read(const std::string& scene_path, const std::string& overrides,
                                       std::vector<std::string>& names) {
  const YamlNode scene = merge_overrides(YamlNode::load_file(scene_path), overrides);
  Entries entries;
  names.clear();
  for (const YamlNode& cable : scene.optional_sequence("cables")) {
    names.push_back(cable.text("name"));
    for (const std::string& key : cable.keys()) entries[names.back()][key] = cable.child(key).dump();
  }
  return entries;
}

SceneCables::SceneCables(const std::string& scene_path, const std::string& overrides)
    : in_file_(read(scene_path, "", names_)), now_(read(scene_path, overrides, names_)) {}

std::optional<std::string> SceneCables::value(const std::string& cable, const std::string& key) const {
  const auto found = now_.find(cable);
  if (found == now_.end() || found->second.count(key) == 0) return std::nullopt;
  return found->second.at(key);
}

void SceneCables::set(const std::string& cable, const std::string& key, const std::string& value) {
  const auto found = now_.find(cable);
  if (found != now_.end()) {
    found->second[key] = value;
    return;
  }
  std::string known;
  for (const std::string& name : names_) known += (known.empty() ? "" : ", ") + name;
  throw std::invalid_argument("unknown cable '" + cable + "'; known: " + (known.empty() ? "none" : known));
}

std::string SceneCables::yaml() const {
  std::string text;
  for (const auto& [cable, entries] : now_) {
    const auto before = in_file_.find(cable);
    std::string changed;
    for (const auto& [key, value] : entries) {
      const bool same = before != in_file_.end() && before->second.count(key) > 0 && before->second.at(key) == value;
      if (!same) changed += (changed.empty() ? "" : ", ") + key + ": " + value;
    }
    if (!changed.empty()) text += "  " + cable + ": {" + changed + "}\n";
  }
  return text.empty() ? "" : "cables:\n" + text;
}

}  // namespace soft_robot_lab
