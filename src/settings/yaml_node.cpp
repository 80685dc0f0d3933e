// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/settings/yaml_node.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "settings_data.h"
#include "unit_limits.h"
#include "words.h"

namespace soft_robot_lab {

void fail_at(const std::string& source, int line, const std::string& path, const std::string& message) {
  throw SettingsError(source + ":" + std::to_string(line) + ": " + (path.empty() ? "" : path + ": ") + message);
}

bool AllowedRange::contains(double value) const {
  if (!std::isfinite(value)) return false;
  return (open_min ? value > min : value >= min) && (open_max ? value < max : value <= max);
}

std::string AllowedRange::to_string() const {
  const bool no_min = open_min || !std::isfinite(min);
  const bool no_max = open_max || !std::isfinite(max);
  return (no_min ? "(" : "[") + format_number(min) + ", " + format_number(max) + (no_max ? ")" : "]");
}

YamlNode::YamlNode(std::shared_ptr<Data> data) : data_(std::move(data)) {}

bool YamlNode::has(const std::string& key) const { return data_->find(key) != nullptr; }
bool YamlNode::is_map() const { return data_->kind == Data::Kind::map; }
bool YamlNode::is_sequence() const { return data_->kind == Data::Kind::sequence; }
bool YamlNode::is_scalar() const { return data_->kind == Data::Kind::scalar; }

std::optional<YamlNode> YamlNode::optional_child(const std::string& key) const {
  if (!is_map()) fail("must hold keys and values, '" + key + "' among them");
  Data::Member* member = data_->find(key);
  if (!member) return std::nullopt;
  member->read = true;
  return member->value;
}

YamlNode YamlNode::child(const std::string& key) const {
  const std::optional<YamlNode> found = optional_child(key);
  if (found) return *found;
  std::vector<std::string> unread;
  for (const Data::Member& member : data_->members)
    if (!member.read) unread.push_back(member.key);
  fail(missing_key_message(key, unread));
}

std::vector<YamlNode> YamlNode::sequence(const std::string& key) const { return child(key).items(); }
double YamlNode::number(const std::string& key, const AllowedRange& range) const { return child(key).as_number(range); }
std::string YamlNode::text(const std::string& key) const { return child(key).as_text(); }

int YamlNode::integer(const std::string& key, int min, int max) const {
  const YamlNode node = child(key);
  const std::string text = node.as_text();
  const std::optional<long long> value = node.data_->quoted ? std::nullopt : parse_number<long long>(text);
  if (!value) node.fail("'" + text + "' is not a whole number");
  if (*value < min || *value > max) {
    node.fail(text + " is out of range [" + std::to_string(min) + ", " + std::to_string(max) + "]");
  }
  return static_cast<int>(*value);
}

bool YamlNode::boolean(const std::string& key) const {
  const YamlNode node = child(key);
  const std::string text = node.as_text();
  if (node.data_->quoted || (text != "true" && text != "false")) node.fail("'" + text + "' is not true or false");
  return text == "true";
}

std::string YamlNode::choice(const std::string& key, const std::vector<std::string>& allowed) const {
  const YamlNode node = child(key);
  const std::string text = node.as_text();
  if (std::find(allowed.begin(), allowed.end(), text) == allowed.end()) {
    node.fail("'" + text + "' is not one of " + join(allowed));
  }
  return text;
}

Eigen::Vector3d YamlNode::vector3(const std::string& key) const {
  const YamlNode node = child(key);
  if (node.is_scalar()) node.fail("must be a list [x, y, z], not the one value '" + node.as_text() + "'");
  const Eigen::VectorXd numbers = node.as_numbers();
  if (numbers.size() != 3) node.fail("has " + std::to_string(numbers.size()) + " numbers, must have 3: [x, y, z]");
  return numbers;
}

std::vector<YamlNode> YamlNode::optional_sequence(const std::string& key) const {
  const std::optional<YamlNode> found = optional_child(key);
  return found ? found->items() : std::vector<YamlNode>{};
}
double YamlNode::number_or(const std::string& key, double otherwise, const AllowedRange& range) const {
  return optional_child(key) ? number(key, range) : otherwise;
}
int YamlNode::integer_or(const std::string& key, int otherwise, int min, int max) const {
  return optional_child(key) ? integer(key, min, max) : otherwise;
}
bool YamlNode::boolean_or(const std::string& key, bool otherwise) const {
  return optional_child(key) ? boolean(key) : otherwise;
}
std::string YamlNode::text_or(const std::string& key, const std::string& otherwise) const {
  return optional_child(key) ? text(key) : otherwise;
}
std::string YamlNode::choice_or(const std::string& key, const std::string& otherwise,
                                const std::vector<std::string>& allowed) const {
  return optional_child(key) ? choice(key, allowed) : otherwise;
}
Eigen::Vector3d YamlNode::vector3_or(const std::string& key, const Eigen::Vector3d& otherwise) const {
  return optional_child(key) ? vector3(key) : otherwise;
}

namespace {

// Why a text is no number, and what was rather meant.
std::string why_no_number(const std::string& text, bool quoted) {
  const std::string is = "'" + text + "' is not a finite number";
  if (quoted && parse_number<double>(text)) return is + " but a text in quotes; leave these out";
  std::string pointed = text;
  if (const std::size_t comma = pointed.find(','); comma != std::string::npos) pointed[comma] = '.';
  if (pointed != text && parse_number<double>(pointed)) return is + ": did you mean " + pointed + "?";
  const std::string first = text.substr(0, text.find(' '));
  if (first != text && parse_number<double>(first)) return is + ": numbers have no unit; keys say which";
  return is;
}

}  // namespace

double YamlNode::as_number(const AllowedRange& range) const {
  const std::string text = as_text();
  const std::optional<double> value = data_->number   ? data_->number
                                      : data_->quoted ? std::nullopt
                                                      : parse_number<double>(text);
  if (!value || !std::isfinite(*value)) fail(why_no_number(text, data_->quoted));
  for (const AllowedRange& allowed : {range, range_of_unit(data_->path)})
    if (!allowed.contains(*value)) fail(text + " is out of range " + allowed.to_string());
  return *value;
}

std::string YamlNode::as_text() const {
  if (data_->kind == Data::Kind::empty) fail("has no value");
  if (!is_scalar()) fail("must be a single value, not a list or a map");
  if (data_->scalar.find('\0') != std::string::npos) fail("holds a byte of value 0, as no text does");
  return data_->scalar;
}

Eigen::VectorXd YamlNode::as_numbers() const {
  const std::vector<YamlNode> list = items();
  Eigen::VectorXd numbers(list.size());
  for (size_t i = 0; i < list.size(); ++i) numbers[static_cast<Eigen::Index>(i)] = list[i].as_number();
  return numbers;
}

std::vector<YamlNode> YamlNode::items() const {
  if (!is_sequence()) fail("must be a list: [...]");
  return data_->items;
}

std::vector<std::string> YamlNode::keys() const {
  if (!is_map()) fail("must hold keys and values");
  std::vector<std::string> names;
  for (const Data::Member& member : data_->members) names.push_back(member.key);
  return names;
}

void YamlNode::require_all_read() const {
  for (const Data::Member& member : data_->members) {
    if (!member.read) fail_at(member.source, member.line, path(), unknown_key_message(member.key, data_->asked));
  }
  for (const Data::Member& member : data_->members) member.value.require_all_read();
  for (const YamlNode& item : data_->items) item.require_all_read();
}

void YamlNode::fail(const std::string& message) const { fail_at(data_->source, data_->line, data_->path, message); }
std::string YamlNode::path() const { return data_->path; }
std::string YamlNode::source() const { return data_->source; }

// Flow style with sorted keys. Text is quoted, numbers and booleans stay as they were written.
std::string YamlNode::dump() const {
  std::vector<std::string> parts;
  switch (data_->kind) {
    case Data::Kind::empty:
      return "null";
    case Data::Kind::scalar: {
      const std::string& text = data_->scalar;
      const bool plain = !data_->quoted && (parse_number<double>(text) || text == "true" || text == "false");
      return plain ? text : quote(text);
    }
    case Data::Kind::sequence:
      for (const YamlNode& item : data_->items) parts.push_back(item.dump());
      return "[" + join(parts) + "]";
    case Data::Kind::map:
      break;
  }
  for (Data::Member& member : data_->members) {
    member.read = true;
    parts.push_back(quote(member.key) + ": " + member.value.dump());
  }
  std::sort(parts.begin(), parts.end());
  return "{" + join(parts) + "}";
}

}  // namespace soft_robot_lab
