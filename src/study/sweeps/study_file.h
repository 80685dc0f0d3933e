// SPDX-License-Identifier: BSD-3-Clause
// A study's file: which program runs on which scene, and over which numbers.
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

enum class SamplingMethod { grid, latin_hypercube, sobol, sobol_indices };

// One dimension of a study: a list of values, or a range.
struct StudyParameter {
  std::string name;            // a path in the scene's file, or a name of its block `parameters`
  std::vector<double> values;  // empty: the range
  double min = 0.0, max = 0.0;
  int steps = 0;             // of a range in a grid, its ends among them
  bool logarithmic = false;  // a range whose logarithm is spread evenly
};

struct StudySettings {
  std::string program;  // simulate, optimise, check_casting
  std::string scene;    // absolute
  std::vector<std::string> arguments;
  std::vector<StudyParameter> parameters;
  SamplingMethod method = SamplingMethod::grid;
  int samples = 0;  // of methods but grid; of sobol_indices: base points
  int seed = 1;
  double time_limit_s = 600.0;    // of one task
  std::vector<std::string> show;  // results in report.html; empty: the first that vary
};

// Throws SettingsError: file, line, key, value and allowed range; also for parameters that the scene does not have.
StudySettings read_study(const std::string& file);

// More would not be kept in memory.
constexpr int kMostTasks = 1000000;

}  // namespace soft_robot_lab
