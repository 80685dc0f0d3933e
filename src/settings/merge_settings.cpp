// SPDX-License-Identifier: BSD-3-Clause
// Settings laid over others.
#include <algorithm>
#include <optional>
#include <utility>

#include "settings_data.h"
#include "words.h"

namespace soft_robot_lab {

std::optional<std::size_t> place_in_list(const std::string& key) {
  if (key.size() < 3 || key.front() != '[' || key.back() != ']') return std::nullopt;
  return parse_number<std::size_t>(key.substr(1, key.size() - 2));
}

// A deep copy, with the marks of what was read already.
YamlNode YamlNode::Data::copy(const YamlNode& node) {
  auto data = std::make_shared<Data>(*node.data_);
  for (YamlNode& item : data->items) item = copy(item);
  for (Member& member : data->members) member.value = copy(member.value);
  return YamlNode(std::move(data));
}

// Both are maps.
YamlNode YamlNode::Data::merge(const YamlNode& base, const YamlNode& overlay) {
  YamlNode merged = copy(overlay);
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
YamlNode YamlNode::Data::change_named(const YamlNode& list, const YamlNode& overrides) {
  YamlNode merged = copy(list);
  std::vector<std::string> names;
  for (YamlNode& item : merged.data_->items) {
    if (!item.is_map() || !item.has("name"))
      list.fail("has items without a name, so that they cannot be changed by it");
    names.push_back(item.text("name"));
    for (const Member& change : overrides.data_->members)
      if (change.key == names.back() && change.value.is_map()) item = merge(item, change.value);
  }
  for (const Member& change : overrides.data_->members) {
    if (!change.value.is_map()) change.value.fail("must hold keys and values that change '" + change.key + "'");
    if (std::find(names.begin(), names.end(), change.key) == names.end())
      change.value.fail("'" + change.key + "' is not one of " + join(names));
  }
  return merged;
}

// A list, and a map from places "[0]" to what changes.
YamlNode YamlNode::Data::change_placed(const YamlNode& list, const YamlNode& overrides) {
  YamlNode merged = copy(list);
  std::vector<YamlNode>& items = merged.data_->items;
  for (const Member& change : overrides.data_->members) {
    const std::optional<std::size_t> place = place_in_list(change.key);
    if (!place) change.value.fail("'" + change.key + "' is no place in a list, as its other keys are: [0]");
    if (*place >= items.size())
      change.value.fail("there is no place " + change.key + " in a list of " + std::to_string(items.size()));
    items[*place] = merge_settings(items[*place], change.value);
  }
  return merged;
}

YamlNode merge_settings(const YamlNode& base, const YamlNode& overlay) {
  using Data = YamlNode::Data;
  if (base.is_sequence() && overlay.is_map()) {
    const auto& members = overlay.data_->members;
    const bool placed = !members.empty() && place_in_list(members.front().key).has_value();
    return placed ? Data::change_placed(base, overlay) : Data::change_named(base, overlay);
  }
  const auto names = [&](const char* key) {  // without asking, which an error would list as a known key
    const auto& members = overlay.data_->members;
    return std::any_of(members.begin(), members.end(), [&](const Data::Member& member) { return member.key == key; });
  };
  if (!base.is_map() || !overlay.is_map() || names("preset") || names("model")) return Data::copy(overlay);
  return Data::merge(base, overlay);
}

}  // namespace soft_robot_lab
