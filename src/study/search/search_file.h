// SPDX-License-Identifier: BSD-3-Clause
// A search's file: which numbers of a robot may change, and what is better.
#pragma once

#include <string>
#include <vector>

#include "study/sweeps/study_file.h"

namespace soft_robot_lab {

// A number of an assessment (assessment.h).
struct Objective {
  std::string name;
  bool larger_is_better = false;
};

struct SearchSettings {
  std::string robot;                       // absolute
  std::vector<StudyParameter> parameters;  // all with a range
  std::vector<Objective> objectives;
  std::vector<std::string> assessment;  // arguments of the program assess
  std::string method;                   // cma_es, differential_evolution, nsga2
  int population = 12, designs = 200, seed = 1;
  bool castable = true;         // designs that cannot be cast are not assessed
  double time_limit_s = 300.0;  // of one task
};

// Throws SettingsError: file, line, key, value and allowed range.
SearchSettings read_search(const std::string& file);

// As one study over the search's parameters.
StudySettings study_of(const SearchSettings& search, const std::string& program,
                       const std::vector<std::string>& arguments = {});

}  // namespace soft_robot_lab
