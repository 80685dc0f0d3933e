// SPDX-License-Identifier: BSD-3-Clause
// How many rollouts a core does in a second.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "soft_robot_lab/settings/yaml_node.h"
#include "study/experiment.h"

namespace soft_robot_lab {

struct RolloutRung {
  std::string name;
  Overrides overrides;
  int count = 0;      // of rollouts
  bool quick = true;  // run with --quick too
};

struct RolloutProblem {
  std::string title, scene;
  double duration_s = 0.0, hold_s = 0.0;        // of a rollout, of each of its commands
  double min_command = 0.0, max_command = 0.0;  // of every actuator
  std::vector<int> threads;
  std::vector<RolloutRung> rungs;
};

struct RolloutRate {
  std::string rung;
  int threads = 0, rollouts = 0, left_reduced = 0, unsolved = 0;
  int modes = 0;               // of a reduced model, else 0
  double training_s = 0.0;     // CPU time, and
  double largest_rms_m = 0.0;  // error on what it was not trained with: of a reduced model
  double cpu_s = 0.0, wall_s = 0.0;

  double per_core_s() const { return rollouts / cpu_s; }  // in a second of a core's time
};

RolloutProblem read_rollouts(const ExperimentContext& context, const YamlNode& node);
RolloutProblem quick_part(RolloutProblem problem);  // one short rollout of each quick rung

std::vector<RolloutRate> run_rollouts(const ExperimentContext& context, const RolloutProblem& problem);

Plot plot_rollouts(const RolloutProblem& problem, const std::vector<RolloutRate>& rates);
nlohmann::ordered_json rollouts_json(const RolloutProblem& problem, const std::vector<RolloutRate>& rates);

}  // namespace soft_robot_lab
