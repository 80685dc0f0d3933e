#include "soft_robot_lab/settings/settings_node.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

#include <yaml-cpp/yaml.h>

namespace soft_robot_lab {

// The document as an own tree: yaml-cpp's nodes forget their file, and cannot say which keys were read.
struct SettingsNode::Data {
  enum class Kind { empty, scalar, sequence, map };
  struct Member {
    std::string key;
    std::string source;  // of the key: a merged map has members from two files
    int line;
    SettingsNode value;
    bool read = false;
  };

  Kind kind = Kind::empty;
  std::string source;
  int line = 1;  // counted from 1
  std::string path;
  std::string scalar;
  bool quoted = false;  // "5" in quotes is text, not a number
  std::vector<SettingsNode> items;
  std::vector<Member> members;
  std::vector<std::string> asked;  // keys that a reader looked for, in that order

  static SettingsNode build(const YAML::Node& yaml, Data place, int depth, int& budget);
  static SettingsNode copy(const SettingsNode& node);
  static SettingsNode lay_over(const SettingsNode& base, const SettingsNode& overlay);
  static SettingsNode change_named(const SettingsNode& list, const SettingsNode& changes);

  Member* find(const std::string& key) {
    if (std::find(asked.begin(), asked.end(), key) == asked.end()) asked.push_back(key);
    const auto found = std::find_if(members.begin(), members.end(), [&](const Member& m) { return m.key == key; });
    return found == members.end() ? nullptr : &*found;
  }
};

namespace {

// Aliases may repeat a part of a document without end; no settings file comes near these.
constexpr int kMaxDepth = 100;
constexpr int kMaxNodes = 1000000;

[[noreturn]] void fail_at(const std::string& source, int line, const std::string& path, const std::string& message) {
  throw SettingsError(source + ":" + std::to_string(line) + ": " + (path.empty() ? "" : path + ": ") + message);
}

std::string join(const std::vector<std::string>& words) {
  std::string joined;
  for (const std::string& word : words) joined += (joined.empty() ? "" : ", ") + word;
  return joined;
}

// A decimal number and nothing else, whatever the locale.
template <typename Number>
std::optional<Number> parse_number(const std::string& text) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  Number value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + (plus ? 1 : 0), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

std::string format_number(double value) {
  std::ostringstream text;
  text.precision(10);
  text << value;
  return text.str();
}

// Levenshtein distance.
size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = std::exchange(row[0], i);
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t change = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({change, row[j] + 1, row[j - 1] + 1}));
    }
  }
  return row[b.size()];
}

std::string unknown_key_message(const std::string& key, std::vector<std::string> known) {
  if (std::find(known.begin(), known.end(), key) != known.end()) return "key '" + key + "' has no use here";
  std::string message = "unknown key '" + key + "'";
  if (known.empty()) return message + "; no keys are known here";
  std::sort(known.begin(), known.end());
  const auto closest = std::min_element(known.begin(), known.end(), [&](const auto& a, const auto& b) {
    return edit_distance(key, a) < edit_distance(key, b);
  });
  if (edit_distance(key, *closest) <= std::max<size_t>(1, key.size() / 3)) {
    message += " (did you mean '" + *closest + "'?)";
  }
  return message + "; known here: " + join(known);
}

std::string quote(const std::string& text) {
  static const char* digits = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (byte < 0x20 || byte == 0x7f) {
      quoted += {'\\', 'x', digits[byte / 16], digits[byte % 16]};
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

}  // namespace

bool AllowedRange::contains(double value) const {
  if (!std::isfinite(value)) return false;
  return (open_min ? value > min : value >= min) && (open_max ? value < max : value <= max);
}

std::string AllowedRange::to_string() const {
  const bool no_min = open_min || !std::isfinite(min);
  const bool no_max = open_max || !std::isfinite(max);
  return (no_min ? "(" : "[") + format_number(min) + ", " + format_number(max) + (no_max ? ")" : "]");
}

SettingsNode::SettingsNode(std::shared_ptr<Data> data) : data_(std::move(data)) {}

// `place` carries source, line and path of the node.
SettingsNode SettingsNode::Data::build(const YAML::Node& yaml, Data place, int depth, int& budget) {
  auto data = std::make_shared<Data>(std::move(place));
  if (depth > kMaxDepth || --budget < 0) fail_at(data->source, data->line, data->path, "nested too deep, or too large");
  const auto place_below = [&](const YAML::Mark& mark, const std::string& path) {
    Data below;
    below.source = data->source;
    below.line = mark.is_null() ? data->line : mark.line + 1;
    below.path = path;
    return below;
  };
  if (yaml.IsScalar()) {
    data->kind = Kind::scalar;
    data->scalar = yaml.Scalar();
    data->quoted = yaml.Tag() == "!" || yaml.Tag() == "tag:yaml.org,2002:str";
  } else if (yaml.IsSequence()) {
    data->kind = Kind::sequence;
    for (const YAML::Node& item : yaml) {
      const std::string path = data->path + "[" + std::to_string(data->items.size()) + "]";
      data->items.push_back(build(item, place_below(item.Mark(), path), depth + 1, budget));
    }
  } else if (yaml.IsMap()) {
    data->kind = Kind::map;
    for (const auto& pair : yaml) {
      Data below = place_below(pair.first.Mark(), data->path);
      if (!pair.first.IsScalar()) fail_at(below.source, below.line, below.path, "a key must be a word");
      const std::string& key = pair.first.Scalar();
      for (const Member& member : data->members) {
        if (member.key != key) continue;
        fail_at(below.source, below.line, below.path,
                "key '" + key + "' stands twice, first in line " + std::to_string(member.line));
      }
      below.path += (below.path.empty() ? "" : ".") + key;
      const int line = below.line;
      data->members.push_back(
          {key, data->source, line, build(pair.second, std::move(below), depth + 1, budget), false});
    }
  }
  return SettingsNode(std::move(data));
}

// A deep copy, with the marks of what was read already.
SettingsNode SettingsNode::Data::copy(const SettingsNode& node) {
  auto data = std::make_shared<Data>(*node.data_);
  for (SettingsNode& item : data->items) item = copy(item);
  for (Member& member : data->members) member.value = copy(member.value);
  return SettingsNode(std::move(data));
}

SettingsNode SettingsNode::load_file(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  if (!file || file.bad() || text.fail()) throw SettingsError(path + ": cannot be read, or is empty");
  return parse(text.str(), path);
}

SettingsNode SettingsNode::parse(const std::string& text, const std::string& source_name) {
  Data root;
  root.source = source_name;
  int budget = kMaxNodes;
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.empty()) throw SettingsError(source_name + ": is empty");
    if (documents.size() > 1) throw SettingsError(source_name + ": holds more than one YAML document");
    return Data::build(documents[0], std::move(root), 0, budget);
  } catch (const YAML::Exception& error) {
    fail_at(source_name, error.mark.is_null() ? 1 : error.mark.line + 1, "", "not YAML: " + error.msg);
  }
}

bool SettingsNode::has(const std::string& key) const { return data_->find(key) != nullptr; }
bool SettingsNode::is_map() const { return data_->kind == Data::Kind::map; }
bool SettingsNode::is_sequence() const { return data_->kind == Data::Kind::sequence; }
bool SettingsNode::is_scalar() const { return data_->kind == Data::Kind::scalar; }

std::optional<SettingsNode> SettingsNode::optional_child(const std::string& key) const {
  if (!is_map()) fail("must hold keys and values, '" + key + "' among them");
  Data::Member* member = data_->find(key);
  if (!member) return std::nullopt;
  member->read = true;
  return member->value;
}

SettingsNode SettingsNode::child(const std::string& key) const {
  const std::optional<SettingsNode> found = optional_child(key);
  if (!found) fail("key '" + key + "' is missing");
  return *found;
}

std::vector<SettingsNode> SettingsNode::sequence(const std::string& key) const { return child(key).items(); }
double SettingsNode::number(const std::string& key, const AllowedRange& range) const {
  return child(key).as_number(range);
}
std::string SettingsNode::text(const std::string& key) const { return child(key).as_text(); }

int SettingsNode::integer(const std::string& key, int min, int max) const {
  const SettingsNode node = child(key);
  const std::string text = node.as_text();
  const std::optional<long long> value = node.data_->quoted ? std::nullopt : parse_number<long long>(text);
  if (!value) node.fail("'" + text + "' is not a whole number");
  if (*value < min || *value > max) {
    node.fail(text + " is out of range [" + std::to_string(min) + ", " + std::to_string(max) + "]");
  }
  return static_cast<int>(*value);
}

bool SettingsNode::boolean(const std::string& key) const {
  const SettingsNode node = child(key);
  const std::string text = node.as_text();
  if (node.data_->quoted || (text != "true" && text != "false")) node.fail("'" + text + "' is not true or false");
  return text == "true";
}

std::string SettingsNode::choice(const std::string& key, const std::vector<std::string>& allowed) const {
  const SettingsNode node = child(key);
  const std::string text = node.as_text();
  if (std::find(allowed.begin(), allowed.end(), text) == allowed.end()) {
    node.fail("'" + text + "' is not one of " + join(allowed));
  }
  return text;
}

Eigen::Vector3d SettingsNode::vector3(const std::string& key) const {
  const SettingsNode node = child(key);
  const Eigen::VectorXd numbers = node.as_numbers();
  if (numbers.size() != 3) node.fail("has " + std::to_string(numbers.size()) + " numbers, must have 3: [x, y, z]");
  return numbers;
}

std::vector<SettingsNode> SettingsNode::optional_sequence(const std::string& key) const {
  const std::optional<SettingsNode> found = optional_child(key);
  return found ? found->items() : std::vector<SettingsNode>{};
}
double SettingsNode::number_or(const std::string& key, double otherwise, const AllowedRange& range) const {
  return optional_child(key) ? number(key, range) : otherwise;
}
int SettingsNode::integer_or(const std::string& key, int otherwise, int min, int max) const {
  return optional_child(key) ? integer(key, min, max) : otherwise;
}
bool SettingsNode::boolean_or(const std::string& key, bool otherwise) const {
  return optional_child(key) ? boolean(key) : otherwise;
}
std::string SettingsNode::text_or(const std::string& key, const std::string& otherwise) const {
  return optional_child(key) ? text(key) : otherwise;
}
std::string SettingsNode::choice_or(const std::string& key, const std::string& otherwise,
                                    const std::vector<std::string>& allowed) const {
  return optional_child(key) ? choice(key, allowed) : otherwise;
}
Eigen::Vector3d SettingsNode::vector3_or(const std::string& key, const Eigen::Vector3d& otherwise) const {
  return optional_child(key) ? vector3(key) : otherwise;
}

double SettingsNode::as_number(const AllowedRange& range) const {
  const std::string text = as_text();
  const std::optional<double> value = data_->quoted ? std::nullopt : parse_number<double>(text);
  if (!value || !std::isfinite(*value)) fail("'" + text + "' is not a finite number");
  if (!range.contains(*value)) fail(text + " is out of range " + range.to_string());
  return *value;
}

std::string SettingsNode::as_text() const {
  if (data_->kind == Data::Kind::empty) fail("has no value");
  if (!is_scalar()) fail("must be a single value, not a list or a map");
  return data_->scalar;
}

Eigen::VectorXd SettingsNode::as_numbers() const {
  const std::vector<SettingsNode> list = items();
  Eigen::VectorXd numbers(list.size());
  for (size_t i = 0; i < list.size(); ++i) numbers[static_cast<Eigen::Index>(i)] = list[i].as_number();
  return numbers;
}

std::vector<SettingsNode> SettingsNode::items() const {
  if (!is_sequence()) fail("must be a list: [...]");
  return data_->items;
}

std::vector<std::string> SettingsNode::keys() const {
  if (!is_map()) fail("must hold keys and values");
  std::vector<std::string> names;
  for (const Data::Member& member : data_->members) names.push_back(member.key);
  return names;
}

void SettingsNode::require_all_read() const {
  for (const Data::Member& member : data_->members) {
    if (!member.read) fail_at(member.source, member.line, path(), unknown_key_message(member.key, data_->asked));
  }
  for (const Data::Member& member : data_->members) member.value.require_all_read();
  for (const SettingsNode& item : data_->items) item.require_all_read();
}

void SettingsNode::fail(const std::string& message) const { fail_at(data_->source, data_->line, data_->path, message); }
std::string SettingsNode::path() const { return data_->path; }
std::string SettingsNode::source() const { return data_->source; }

// Flow style with sorted keys. Text is quoted, numbers and booleans stay as they were written.
std::string SettingsNode::dump() const {
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
      for (const SettingsNode& item : data_->items) parts.push_back(item.dump());
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
