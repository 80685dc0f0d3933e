// SPDX-License-Identifier: BSD-3-Clause
// What the program `experiment` can repeat: an experiment of the thesis, named by its section, or one of ours.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "session/report/plot.h"
#include "session/report/table.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

inline constexpr const char* kTip = "tip";  // the marker at a robot's end

struct ExperimentContext {
  std::string config_folder;  // the package's config/: robots, scenes, experiments, reference
  std::string output_folder;  // exists; for files of its own (plots and table are written by the program)
  std::string mesher;         // as in SceneOptions
  // Share done in [0, 1], and what is done now; may be empty: call report().
  std::function<void(double fraction, const std::string& what)> progress;

  void report(double fraction, const std::string& what) const {
    if (progress) progress(fraction, what);
  }
  // To load a scene with our actuators, the overrides laid over it.
  SceneOptions scene_options(const Overrides& overrides = {}) const;
  // The experiment's settings: config/experiments/NAME.yaml.
  std::string settings_file(const std::string& name) const { return config_folder + "/experiments/" + name + ".yaml"; }
};

struct ExperimentResult {
  std::string title;
  Table table;
  std::vector<Plot> plots;
  nlohmann::ordered_json numbers;  // beyond the table, an object; may stay null
  std::string source_reports;      // what the source reports, a paragraph; empty where it has no such experiment
  std::string we_differ;           // where and why our set-up is not the source's, a sentence; empty where it is
  std::string we_find;             // a paragraph
  bool converged = true;           // every solve of it
  std::string message;             // where one did not: which, and why
};

struct Experiment {
  std::string name;     // "4.3.2", "cantilever": letters, digits, '.', '_', '-'
  std::string summary;  // a line for --list
  // Throws SettingsError, std::invalid_argument for bad settings, std::runtime_error where it cannot run.
  std::function<ExperimentResult(const ExperimentContext&)> run;
};

// A part's experiments are a function like this one; the program puts the lists of its parts together.
std::vector<Experiment> simulation_experiments();

}  // namespace soft_robot_lab
