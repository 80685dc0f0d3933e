#include "soft_robot_lab/scene/scene_cables.h"

#include <algorithm>
#include <stdexcept>

#include "scene/sections.h"

namespace soft_robot_lab {

SceneCables::SceneCables(const std::string& scene_path, const std::string& changes) {
  const SettingsNode scene = read_settings(scene_path, changes);
  for (const SettingsNode& node : scene.optional_sequence("cables")) {
    Cable cable{node.text("name"), {}};
    for (const std::string& key : node.keys()) cable.entries.emplace_back(key, node.child(key).dump());
    cables_.push_back(std::move(cable));
  }
}

std::vector<std::string> SceneCables::names() const {
  std::vector<std::string> names;
  for (const Cable& cable : cables_) names.push_back(cable.name);
  return names;
}

SceneCables::Cable& SceneCables::find(const std::string& cable) {
  const auto found = std::find_if(cables_.begin(), cables_.end(), [&](const Cable& c) { return c.name == cable; });
  if (found != cables_.end()) return *found;
  std::string known;
  for (const Cable& c : cables_) known += (known.empty() ? "" : ", ") + c.name;
  throw std::invalid_argument("unknown cable '" + cable + "'; known: " + (known.empty() ? "none" : known));
}

std::optional<std::string> SceneCables::value(const std::string& cable, const std::string& key) const {
  for (const Cable& c : cables_)
    for (const auto& [name, value] : c.entries)
      if (c.name == cable && name == key) return value;
  return std::nullopt;
}

void SceneCables::set(const std::string& cable, const std::string& key, const std::string& value) {
  std::vector<Entry>& entries = find(cable).entries;
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.first == key; });
  if (found != entries.end()) {
    found->second = value;
  } else {
    entries.emplace_back(key, value);
  }
  changed_ = true;
}

std::string SceneCables::yaml() const {
  if (!changed_) return "";
  std::string text = "cables:\n";
  for (const Cable& cable : cables_) {
    text += "  - {";
    for (std::size_t i = 0; i < cable.entries.size(); ++i)
      text += (i ? ", " : "") + cable.entries[i].first + ": " + cable.entries[i].second;
    text += "}\n";
  }
  return text;
}

}  // namespace soft_robot_lab
