#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "soft_robot_lab/settings/settings_node.h"

namespace YAML {
class Node;
}

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

  static SettingsNode build(const YAML::Node& yaml, Data place, int depth, long& bytes_left);
  static SettingsNode copy(const SettingsNode& node);
  static SettingsNode lay_over(const SettingsNode& base, const SettingsNode& overlay);
  static SettingsNode change_named(const SettingsNode& list, const SettingsNode& changes);

  Member* find(const std::string& key) {
    if (std::find(asked.begin(), asked.end(), key) == asked.end()) asked.push_back(key);
    const auto found = std::find_if(members.begin(), members.end(), [&](const Member& m) { return m.key == key; });
    return found == members.end() ? nullptr : &*found;
  }
};

[[noreturn]] void fail_at(const std::string& source, int line, const std::string& path, const std::string& message);

}  // namespace soft_robot_lab
