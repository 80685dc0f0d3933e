// SPDX-License-Identifier: BSD-3-Clause
// Numbers of a scene's file that are set from outside: by their path, or by a name that the file's `parameters` give.
//   body.material.youngs_modulus_pa      cables.left.points_m[3][0]      body.solid.union[2].box.size_m[0]
// An item of a list is named by its place, or by its `name`.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "soft_robot_lab/robot/scene/scene.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

// A path or name, and its value.
using ParameterValues = std::vector<std::pair<std::string, double>>;

// One of `parameters`: each of its numbers becomes the value times its factor.
struct NamedParameter {
  std::string name;
  std::vector<std::pair<std::string, double>> factors;  // by path
  double min = 0.0, max = 0.0;                          // min < max
};

// "cables.left.points_m[3][0]" is cables, left, points_m, [3], [0]. Throws std::invalid_argument.
std::vector<std::string> path_steps(const std::string& path);

// A file with what it includes. Throws SettingsError.
YamlNode load_settings(const std::string& path);

// The scene's block `parameters`, empty where it has none. Throws SettingsError, also where a path leads to no number.
std::vector<NamedParameter> read_parameters(const YamlNode& scene);

// The number at a path. Throws std::invalid_argument: the path, where it ends, and what there is instead.
double number_at(const YamlNode& scene, const std::string& path);

// `scene` has its includes. Throws std::invalid_argument: an unknown path, a value beyond the range of a named
// parameter or not finite, a number that is set twice.
Overrides parameter_overrides(const YamlNode& scene, const ParameterValues& values);

// "PATH=VALUE". Throws std::invalid_argument.
ParameterValues parse_parameters(const std::vector<std::string>& words);

// The same for a program with the option --set; empty where there are none.
Overrides parameter_overrides(const std::string& scene_file, const std::vector<std::string>& words);

}  // namespace soft_robot_lab
