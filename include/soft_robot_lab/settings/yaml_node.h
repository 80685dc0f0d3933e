// SPDX-License-Identifier: BSD-3-Clause
// Strict reading of YAML: every key is read exactly once, or it is an error with file and line.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace soft_robot_lab {

// What a scene, robot or policy file got wrong: "scene.yaml:12: cables[0].model: 'glide' is not one of sliding".
class SettingsError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

// A closed interval of allowed numbers, or a half-open one where `open_min` / `open_max` say so.
struct AllowedRange {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open_min = false;
  bool open_max = false;

  static AllowedRange any() { return {}; }
  static AllowedRange positive() { return {0.0, std::numeric_limits<double>::infinity(), true, false}; }
  static AllowedRange not_negative() { return {0.0, std::numeric_limits<double>::infinity(), false, false}; }
  bool contains(double value) const;  // false for NaN and infinities
  std::string to_string() const;      // "(0, inf)"
};

// One node of a YAML document that remembers its file, line and path, and which of its keys were read.
class YamlNode {
 public:
  // Throws SettingsError: unreadable file, or text that is not YAML (with the line).
  static YamlNode load_file(const std::string& path);
  static YamlNode parse(const std::string& text, const std::string& source_name);

  bool has(const std::string& key) const;
  bool is_map() const;
  bool is_sequence() const;
  bool is_scalar() const;

  // Required members; absent ones, wrong types and values out of range throw SettingsError.
  YamlNode child(const std::string& key) const;
  std::vector<YamlNode> sequence(const std::string& key) const;  // the items of a list
  double number(const std::string& key, const AllowedRange& range = AllowedRange::any()) const;
  int integer(const std::string& key, int min, int max) const;
  bool boolean(const std::string& key) const;
  std::string text(const std::string& key) const;
  std::string choice(const std::string& key, const std::vector<std::string>& allowed) const;
  Eigen::Vector3d vector3(const std::string& key) const;  // [x, y, z], finite

  // Optional members: the given default when the key is absent, never when it is wrong.
  std::optional<YamlNode> optional_child(const std::string& key) const;
  std::vector<YamlNode> optional_sequence(const std::string& key) const;
  double number_or(const std::string& key, double otherwise, const AllowedRange& range = AllowedRange::any()) const;
  int integer_or(const std::string& key, int otherwise, int min, int max) const;
  bool boolean_or(const std::string& key, bool otherwise) const;
  std::string text_or(const std::string& key, const std::string& otherwise) const;
  std::string choice_or(const std::string& key, const std::string& otherwise,
                        const std::vector<std::string>& allowed) const;
  Eigen::Vector3d vector3_or(const std::string& key, const Eigen::Vector3d& otherwise) const;

  // This node itself as a value (an item of a list).
  double as_number(const AllowedRange& range = AllowedRange::any()) const;
  std::string as_text() const;
  Eigen::VectorXd as_numbers() const;     // a list of finite numbers of any length
  std::vector<YamlNode> items() const;    // when this node is a list
  std::vector<std::string> keys() const;  // when this node is a map; reading them marks nothing

  // Throws for the first key, here or below, that nobody read: call once, when a document was read.
  void require_all_read() const;

  // Throws SettingsError at this node's place: "file:line: path: message".
  [[noreturn]] void fail(const std::string& message) const;
  std::string path() const;    // "cables[0].points_m"
  std::string source() const;  // the file it came from
  std::string dump() const;    // canonical YAML text of this node, for hashing; marks everything below as read

 private:
  struct Data;
  explicit YamlNode(std::shared_ptr<Data> data);
  std::shared_ptr<Data> data_;
  friend YamlNode merge_settings(const YamlNode& base, const YamlNode& overlay);
  friend class OverrideValue;  // overrides.h
  friend class Overrides;
};

// The base with the overlay's keys over it: maps merge key by key, everything else replaces. So does a map that names a
// `preset` or `model`, for its other keys belong to that. Over a list of items with names, a map {name: {key: value}}
// changes keys of those items. Throws SettingsError where no item has the name.
YamlNode merge_settings(const YamlNode& base, const YamlNode& overlay);

}  // namespace soft_robot_lab
