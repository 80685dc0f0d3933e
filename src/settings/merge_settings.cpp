// Settings laid over others.
#include <algorithm>
#include <utility>

#include "settings/settings_data.h"
#include "settings/words.h"

namespace soft_robot_lab {

// A deep copy, with the marks of what was read already.
SettingsNode SettingsNode::Data::copy(const SettingsNode& node) {
  auto data = std::make_shared<Data>(*node.data_);
  for (SettingsNode& item : data->items) item = copy(item);
  for (Member& member : data->members) member.value = copy(member.value);
  return SettingsNode(std::move(data));
}

// Both are maps.
SettingsNode SettingsNode::Data::lay_over(const SettingsNode& base, const SettingsNode& overlay) {
  SettingsNode merged = copy(overlay);
  for (const Member& member : base.data_->members) {
    auto& members = merged.data_->members;
    const auto over = std::find_if(members.begin(), members.end(), [&](const auto& m) { return m.key == member.key; });
    if (over != members.end()) {
      over->value = merge_settings(member.value, over->value);
    } else {
      members.push_back(member);
      members.back().value = copy(member.value);
    }
  }
  return merged;
}

// A list of named items, and a map from names to what changes.
SettingsNode SettingsNode::Data::change_named(const SettingsNode& list, const SettingsNode& changes) {
  SettingsNode merged = copy(list);
  std::vector<std::string> names;
  for (SettingsNode& item : merged.data_->items) {
    if (!item.is_map() || !item.has("name"))
      list.fail("has items without a name, so that they cannot be changed by it");
    names.push_back(item.text("name"));
    for (const Member& change : changes.data_->members)
      if (change.key == names.back() && change.value.is_map()) item = lay_over(item, change.value);
  }
  for (const Member& change : changes.data_->members) {
    if (!change.value.is_map()) change.value.fail("must hold keys and values that change '" + change.key + "'");
    if (std::find(names.begin(), names.end(), change.key) == names.end())
      change.value.fail("'" + change.key + "' is not one of " + join(names));
  }
  return merged;
}

SettingsNode merge_settings(const SettingsNode& base, const SettingsNode& overlay) {
  using Data = SettingsNode::Data;
  if (base.is_sequence() && overlay.is_map()) return Data::change_named(base, overlay);
  const auto names = [&](const char* key) {  // without asking, which an error would list as a known key
    const auto& members = overlay.data_->members;
    return std::any_of(members.begin(), members.end(), [&](const Data::Member& member) { return member.key == key; });
  };
  if (!base.is_map() || !overlay.is_map() || names("preset") || names("model")) return Data::copy(overlay);
  return Data::lay_over(base, overlay);
}

}  // namespace soft_robot_lab
