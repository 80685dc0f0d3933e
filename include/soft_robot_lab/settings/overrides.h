// SPDX-License-Identifier: BSD-3-Clause
// What a program changes in settings that were read from a file: keys with values, which never are text.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

class Overrides;

// A number, a word, a vector, a list of values, or keys with values. Numbers keep every bit.
class OverrideValue {
 public:
  OverrideValue(double number);
  OverrideValue(int number);
  OverrideValue(bool yes);
  OverrideValue(const char* word);
  OverrideValue(const std::string& word);
  OverrideValue(const Eigen::Vector3d& vector);
  OverrideValue(const std::vector<Eigen::Vector3d>& points);
  OverrideValue(const std::vector<OverrideValue>& list);
  OverrideValue(const Overrides& keys);
  OverrideValue(const YamlNode& part);  // of a file; counts as read there

 private:
  std::optional<YamlNode> node_;  // always one
  friend class Overrides;
};

class Overrides {
 public:
  Overrides() = default;                         // change nothing
  explicit Overrides(const YamlNode& settings);  // keys that stand in a file; they count as read there

  // {"body", "element_size_m"}: maps on the way are made where there are none. An item of a list is named by its
  // `name`, or by its place "[0]". What stood there is replaced.
  Overrides& set(const std::vector<std::string>& path, const OverrideValue& value);
  Overrides& lay(const Overrides& top);  // over these, as merge_settings does

  bool empty() const { return !root_; }
  bool has(const std::vector<std::string>& path) const;

  // The base with these over it, a copy. An error in a value names the base's file "(with changes)", or the file that
  // the value came from. Throws SettingsError as merge_settings does.
  YamlNode over(const YamlNode& base) const;

  std::string text() const;  // YAML, a line a key, to be written into a file after other keys

 private:
  std::optional<YamlNode> root_;  // a map
  friend class OverrideValue;
};

}  // namespace soft_robot_lab
