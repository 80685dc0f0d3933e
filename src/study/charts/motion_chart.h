// SPDX-License-Identifier: BSD-3-Clause
// A robot in motion: how exact the full model by each method, and reduced models, follow it at what cost.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "soft_robot_lab/settings/yaml_node.h"
#include "study/experiment.h"

namespace soft_robot_lab {

struct MotionRung {
  std::string name;
  Overrides overrides;             // over the scene
  int modes = 0;                   // of a reduced model; 0: the full one
  std::vector<int> steps = {1};    // in a frame, one run each
  std::vector<int> substeps = {};  // of each step, one run each; empty: as the scene has them
  bool quick = true;               // run with --quick too
};

struct MotionProblem {
  std::string title, scene;
  double frame_s = 0.0, duration_s = 0.0;
  double min_command = 0.0, max_command = 0.0;  // of every actuator, also in training
  int ramps = 30;                               // of training, and its motion
  double transient_s = 10.0;
  MotionRung reference;
  std::vector<MotionRung> rungs;
};

struct MotionRun {
  std::string rung;
  int steps = 0, substeps = 0, modes = 0;   // substeps: of a step; modes: of a reduced model, else 0
  int nodes = 0, unsolved = 0;              // unsolved: steps
  double cost = 0.0;                        // CPU-seconds per simulated second
  double rms_m = 0.0, largest_m = 0.0;      // distance of nodes from the reference, over all frames
  double training_s = 0.0, beside_m = 0.0;  // CPU time; rms distance from the full model with the same steps: reduced
};

MotionProblem read_motion(const ExperimentContext& context, const YamlNode& node, double frame_s);

// The coarsest run of each quick rung over a few frames, with next to no training.
MotionProblem quick_part(MotionProblem problem);

std::vector<MotionRun> run_motion(const ExperimentContext& context, const MotionProblem& problem);

Plot plot_motion(const MotionProblem& problem, const std::vector<MotionRun>& runs);
nlohmann::ordered_json motion_json(const std::vector<MotionRun>& runs);

}  // namespace soft_robot_lab
