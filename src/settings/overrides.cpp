// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/settings/overrides.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include "settings_data.h"

namespace soft_robot_lab {
namespace {

constexpr double kLargestWhole = 1e15;  // written without an exponent, as counts are read

// Reads back as the same number.
std::string exact_text(double value) {
  const bool whole = value == std::floor(value) && std::abs(value) < kLargestWhole;
  char text[40];
  char* const end = text + sizeof text;
  return {text,
          (whole ? std::to_chars(text, end, static_cast<long long>(value)) : std::to_chars(text, end, value)).ptr};
}

}  // namespace

// --- nodes without text ---

YamlNode::Data YamlNode::Data::of(Kind kind) {
  Data data;
  data.kind = kind;
  return data;
}

YamlNode YamlNode::Data::unread(const YamlNode& node) {
  auto data = std::make_shared<Data>(*node.data_);
  for (Member& member : node.data_->members) member.read = true;
  for (Member& member : data->members) {
    member.read = false;
    member.value = unread(member.value);
  }
  for (YamlNode& item : data->items) item = unread(item);
  return YamlNode(std::move(data));
}

// A copy of the way to the value; all else is shared.
YamlNode YamlNode::Data::with(const YamlNode& node, const std::vector<std::string>& path, std::size_t step,
                              const YamlNode& value) {
  if (step == path.size()) return value;
  const std::string& key = path[step];
  auto data = std::make_shared<Data>(*node.data_);
  if (node.is_sequence()) {
    const std::optional<std::size_t> place = place_in_list(key);
    for (std::size_t i = 0; i < data->items.size(); ++i) {
      const YamlNode& item = data->items[i];
      if (place ? *place != i : !item.is_map() || !item.has("name") || item.text("name") != key) continue;
      data->items[i] = with(item, path, step + 1, value);
      return YamlNode(std::move(data));
    }
    node.fail("there is no '" + key + "' in the list");
  }
  if (!node.is_map()) *data = of(Kind::map);
  auto& members = data->members;
  auto member = std::find_if(members.begin(), members.end(), [&](const Member& one) { return one.key == key; });
  if (member == members.end()) member = members.insert(members.end(), {key, "", 1, no_keys()});
  member->value = with(member->value, path, step + 1, value);
  return YamlNode(std::move(data));
}

YamlNode YamlNode::Data::placed(const YamlNode& node, const std::string& source, const std::string& path) {
  auto data = std::make_shared<Data>(*node.data_);
  if (data->source.empty()) {
    data->source = source;
    data->path = path;
  }
  for (Member& member : data->members) {
    if (member.source.empty()) member.source = source;
    member.value = placed(member.value, source, path + (path.empty() ? "" : ".") + member.key);
  }
  for (std::size_t i = 0; i < data->items.size(); ++i)
    data->items[i] = placed(data->items[i], source, path + "[" + std::to_string(i) + "]");
  return YamlNode(std::move(data));
}

// --- values ---

OverrideValue::OverrideValue(double number) {
  YamlNode::Data data = YamlNode::Data::of(YamlNode::Data::Kind::scalar);
  data.scalar = exact_text(number);
  data.number = number;
  node_ = YamlNode::Data::make(std::move(data));
}

OverrideValue::OverrideValue(int number) : OverrideValue(static_cast<double>(number)) {}

OverrideValue::OverrideValue(bool yes) {
  YamlNode::Data data = YamlNode::Data::of(YamlNode::Data::Kind::scalar);
  data.scalar = yes ? "true" : "false";
  node_ = YamlNode::Data::make(std::move(data));
}

OverrideValue::OverrideValue(const std::string& word) {
  YamlNode::Data data = YamlNode::Data::of(YamlNode::Data::Kind::scalar);
  data.scalar = word;
  data.quoted = true;
  node_ = YamlNode::Data::make(std::move(data));
}

OverrideValue::OverrideValue(const char* word) : OverrideValue(std::string(word)) {}

OverrideValue::OverrideValue(const std::vector<OverrideValue>& list) {
  YamlNode::Data data = YamlNode::Data::of(YamlNode::Data::Kind::sequence);
  for (const OverrideValue& value : list) data.items.push_back(*value.node_);
  node_ = YamlNode::Data::make(std::move(data));
}

OverrideValue::OverrideValue(const Eigen::Vector3d& vector)
    : OverrideValue(std::vector<OverrideValue>{vector.x(), vector.y(), vector.z()}) {}

OverrideValue::OverrideValue(const std::vector<Eigen::Vector3d>& points)
    : OverrideValue(std::vector<OverrideValue>(points.begin(), points.end())) {}

OverrideValue::OverrideValue(const Overrides& keys) : node_(keys.root_ ? *keys.root_ : YamlNode::Data::no_keys()) {}

OverrideValue::OverrideValue(const YamlNode& part) : node_(YamlNode::Data::unread(part)) {}

// --- overrides ---

Overrides::Overrides(const YamlNode& settings) {
  if (!settings.is_map()) settings.fail("must hold keys and values");
  root_ = YamlNode::Data::unread(settings);
}

Overrides& Overrides::set(const std::vector<std::string>& path, const OverrideValue& value) {
  root_ = YamlNode::Data::with(root_ ? *root_ : YamlNode::Data::no_keys(), path, 0, *value.node_);
  return *this;
}

Overrides& Overrides::lay(const Overrides& top) {
  if (top.root_) root_ = root_ ? merge_settings(*root_, *top.root_) : *top.root_;
  return *this;
}

bool Overrides::has(const std::vector<std::string>& path) const {
  std::optional<YamlNode> node = root_;
  for (const std::string& step : path) {
    if (!node || !node->is_map()) return false;
    node = YamlNode::Data::unread(*node).optional_child(step);
  }
  return node.has_value();
}

YamlNode Overrides::over(const YamlNode& base) const {
  const YamlNode top = root_ ? *root_ : YamlNode::Data::no_keys();
  return merge_settings(base, YamlNode::Data::placed(top, base.source() + " (with changes)", ""));
}

std::string Overrides::text() const {
  std::string text;
  if (root_)
    for (const YamlNode::Data::Member& member : root_->data_->members)
      text += member.key + ": " + YamlNode::Data::unread(member.value).dump() + "\n";
  return text;
}

}  // namespace soft_robot_lab
