// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "soft_robot_lab/settings/yaml_node.h"

namespace YAML {
class Node;
}

namespace soft_robot_lab {

// The document as an own tree: yaml-cpp's nodes forget their file, and cannot say which keys were read.
struct YamlNode::Data {
  enum class Kind { empty, scalar, sequence, map };
  struct Member {
    std::string key;
    std::string source;  // of the key: a merged map has members from two files
    int line;
    YamlNode value;
    bool read = false;
  };

  Kind kind = Kind::empty;
  std::string source;
  int line = 1;  // counted from 1
  std::string path;
  std::string scalar;
  std::optional<double> number;  // that a program made; `scalar` shows it
  bool quoted = false;           // "5" in quotes is text, not a number
  std::vector<YamlNode> items;
  std::vector<Member> members;
  std::vector<std::string> asked;  // keys that a reader looked for, in that order

  static YamlNode build(const YAML::Node& yaml, Data place, int depth, long& bytes_left);
  static YamlNode copy(const YamlNode& node);
  static YamlNode merge(const YamlNode& base, const YamlNode& overlay);
  static YamlNode change_named(const YamlNode& list, const YamlNode& overrides);
  static YamlNode change_placed(const YamlNode& list, const YamlNode& overrides);

  // Nodes that a program makes (overrides.cpp) have no source until they are laid over a file's.
  static YamlNode make(Data data) { return YamlNode(std::make_shared<Data>(std::move(data))); }
  static Data of(Kind kind);
  static YamlNode no_keys() { return make(of(Kind::map)); }
  static YamlNode unread(const YamlNode& node);  // a copy; the node counts as read
  static YamlNode with(const YamlNode& node, const std::vector<std::string>& path, std::size_t step,
                       const YamlNode& value);
  static YamlNode placed(const YamlNode& node, const std::string& source, const std::string& path);

  Member* find(const std::string& key) {
    if (std::find(asked.begin(), asked.end(), key) == asked.end()) asked.push_back(key);
    const auto found = std::find_if(members.begin(), members.end(), [&](const Member& m) { return m.key == key; });
    return found == members.end() ? nullptr : &*found;
  }
};

std::optional<std::size_t> place_in_list(const std::string& key);  // "[3]" is 3

[[noreturn]] void fail_at(const std::string& source, int line, const std::string& path, const std::string& message);

}  // namespace soft_robot_lab
