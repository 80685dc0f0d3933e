// SPDX-License-Identifier: BSD-3-Clause
// A study's file: which program runs on which scene, and over which numbers.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "settings/limits.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

enum class SamplingMethod { grid, latin_hypercube, sobol, sobol_indices };

enum class Distribution { even, normal, log_normal };

// One dimension of a study: a list of values, a range, or a distribution.
struct StudyParameter {
  std::string name;             // a path in the scene's file, or a name of its block `parameters`
  std::vector<double> values;   // empty: the range
  double min = 0.0, max = 0.0;  // of a distribution where it is cut off; infinite for none
  int steps = 0;                // of a range in a grid, its ends among them
  bool logarithmic = false;     // a range whose logarithm is spread evenly
  Distribution distribution = Distribution::even;
  double centre = 0.0;     // mean of a normal one, median of a log-normal one
  double deviation = 0.0;  // standard; of a log-normal one that of the natural logarithm
};

struct StudySettings {
  std::string program;                 // simulate, optimise, check_casting, rollouts, fit_model
  std::string scene;                   // absolute
  std::vector<std::string> arguments;  // those that name a file beside the study are absolute
  std::vector<StudyParameter> parameters;
  SamplingMethod method = SamplingMethod::grid;
  int samples = 0;  // of methods but grid; of sobol_indices: base points
  int seed = 1;
  double time_limit_s = 600.0;    // of one task
  std::vector<std::string> show;  // results in report.html; empty: the first that vary
};

// Throws SettingsError: file, line, key, value and allowed range; also for parameters that the scene does not have.
StudySettings read_study(const std::string& file);

// The block `parameters` of a study or a search, and the scene at `key`, for which file and line count in errors.
// `of_no_file`, where given, names parameters that are no numbers of the scene.
std::vector<StudyParameter> read_study_parameters(const YamlNode& file, SamplingMethod method, const YamlNode& scene,
                                                  const std::function<bool(const std::string&)>& of_no_file = {});
std::string read_scene_path(const YamlNode& file, const std::string& key);

// More would not be kept in memory.
constexpr int kMostTasks = limits::kTasks;

}  // namespace soft_robot_lab
