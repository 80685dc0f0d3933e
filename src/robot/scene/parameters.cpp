// SPDX-License-Identifier: BSD-3-Clause
#include "parameters.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>

#include "sections.h"
#include "settings/read_name.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

std::string path_of(const std::vector<std::string>& steps) {
  std::string path;
  for (const std::string& step : steps) path += (path.empty() || step.front() == '[' ? "" : ".") + step;
  return path;
}

std::string name_of(const YamlNode& item) {
  return item.is_map() && item.has("name") ? item.text("name") : std::string();
}

// A number, and the steps to it.
struct Place {
  YamlNode node;
  std::vector<std::string> steps;
};

// By their names where each has one of its own, otherwise by their places.
std::vector<std::string> steps_to(const std::vector<YamlNode>& items) {
  std::vector<std::string> names, places;
  for (std::size_t i = 0; i < items.size(); ++i) {
    places.push_back("[" + std::to_string(i) + "]");
    names.push_back(name_of(items[i]));
  }
  const std::set<std::string> different(names.begin(), names.end());
  return different.size() == items.size() && different.count("") == 0 ? names : places;
}

// Goes one step on, where there is one.
bool go(Place& place, const std::string& step) {
  if (!place.node.is_sequence()) {
    const auto member = place.node.is_map() ? place.node.optional_child(step) : std::nullopt;
    if (!member) return false;
    place.node = *member;
    place.steps.push_back(step);
    return true;
  }
  const std::vector<YamlNode> items = place.node.items();
  const std::vector<std::string> steps = steps_to(items);
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (step != "[" + std::to_string(i) + "]" && name_of(items[i]) != step) continue;
    place.node = items[i];
    place.steps.push_back(steps[i]);
    return true;
  }
  return false;
}

std::string what_is_there(const YamlNode& node) {
  if (node.is_map()) return "it has " + join(node.keys());
  if (!node.is_sequence()) return "it is a single value";
  std::vector<std::string> names;
  for (const YamlNode& item : node.items())
    if (const std::string name = name_of(item); !name.empty()) names.push_back(name);
  return "it is a list of " + std::to_string(node.items().size()) + (names.empty() ? "" : ": " + join(names));
}

Place place_of(const YamlNode& scene, const std::string& path) {
  Place place{scene, {}};
  for (const std::string& step : path_steps(path)) {
    if (go(place, step)) continue;
    const std::string where = place.steps.empty() ? "the file" : "'" + path_of(place.steps) + "'";
    throw std::invalid_argument("there is no '" + path + "' in " + scene.source() + ": no '" + step + "' in " + where +
                                "; " + what_is_there(place.node));
  }
  if (place.node.is_map() || place.node.is_sequence())
    throw std::invalid_argument("'" + path + "' in " + scene.source() + " is no number: " + what_is_there(place.node));
  place.node.as_number();
  return place;
}

NamedParameter read_parameter(const YamlNode& owner, const std::string& name) {
  const YamlNode node = owner.child(name);
  NamedParameter parameter{name, {}, 0.0, 0.0};
  const Eigen::VectorXd range = node.child("range").as_numbers();
  if (range.size() != 2 || !(range[0] < range[1]))
    node.child("range").fail("must be [least, largest], least < largest");
  parameter.min = range[0];
  parameter.max = range[1];
  const YamlNode factors = node.child("factors");
  for (const std::string& path : factors.keys()) parameter.factors.emplace_back(path, factors.number(path));
  if (parameter.factors.empty()) factors.fail("must hold at least one path with its factor");
  return parameter;
}

// What a value changes: the paths, each with its new number.
ParameterValues spread(const std::vector<NamedParameter>& known, const std::string& name, double value) {
  if (!std::isfinite(value)) throw std::invalid_argument("parameter '" + name + "': the value is not a finite number");
  const auto found = std::find_if(known.begin(), known.end(), [&](const auto& one) { return one.name == name; });
  if (found == known.end()) return {{name, value}};
  if (const AllowedRange range{found->min, found->max}; !range.contains(value))
    throw std::invalid_argument("parameter '" + name + "': " + format_number(value) + " is out of range " +
                                range.to_string() + " of the file's parameters." + name + ".range");
  ParameterValues changes;
  for (const auto& [path, factor] : found->factors) changes.emplace_back(path, factor * value);
  return changes;
}

}  // namespace

std::vector<std::string> path_steps(const std::string& path) {
  std::vector<std::string> steps(1);
  for (const char c : path) {
    if (c == '.' || c == '[') steps.emplace_back();
    if (c != '.') steps.back() += c;
  }
  for (const std::string& step : steps)
    if (step.empty() || (step.front() == '[') != (step.back() == ']'))
      throw std::invalid_argument("'" + path + "' is no path as cables.left.points_m[3][0]");
  return steps;
}

YamlNode load_settings(const std::string& path) { return with_includes(YamlNode::load_file(path)); }

double number_at(const YamlNode& scene, const std::string& path) { return place_of(scene, path).node.as_number(); }

std::vector<NamedParameter> read_parameters(const YamlNode& scene) {
  std::vector<NamedParameter> parameters;
  const std::optional<YamlNode> block = scene.optional_child("parameters");
  if (!block) return parameters;
  for (const std::string& name : block->keys()) {
    parameters.push_back(read_parameter(*block, name));
    for (const auto& factor : parameters.back().factors)
      in_section(block->child(name), [&] { return number_at(scene, factor.first); });
  }
  return parameters;
}

Overrides parameter_overrides(const YamlNode& scene, const ParameterValues& values) {
  Overrides overrides;
  if (values.empty()) return overrides;
  const std::vector<NamedParameter> known = read_parameters(scene);
  std::set<std::vector<std::string>> set;
  for (const auto& [name, value] : values)
    for (const auto& [path, number] : spread(known, name, value)) {
      const std::vector<std::string> steps = place_of(scene, path).steps;
      if (!set.insert(steps).second)
        throw std::invalid_argument("parameter '" + name + "': '" + path + "' is set twice");
      overrides.set(steps, number);
    }
  return overrides;
}

ParameterValues parse_parameters(const std::vector<std::string>& words) {
  ParameterValues values;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    const auto value = equals == std::string::npos ? std::nullopt : parse_number<double>(word.substr(equals + 1));
    if (!value) throw std::invalid_argument("--set " + word + ": must be PATH=NUMBER");
    values.emplace_back(word.substr(0, equals), *value);
  }
  return values;
}

Overrides parameter_overrides(const std::string& scene_file, const std::vector<std::string>& words) {
  return words.empty() ? Overrides() : parameter_overrides(load_settings(scene_file), parse_parameters(words));
}

}  // namespace soft_robot_lab
