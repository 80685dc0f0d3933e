// SPDX-License-Identifier: BSD-3-Clause
// Where the commands of rollouts come from: a table, NumPy's arrays, or chance.
#pragma once

#include <string>
#include <vector>

#include "mechanics/reduced/reduced_model.h"
#include "soft_robot_lab/robot/rollouts/batch.h"

namespace soft_robot_lab {

// The reduced model's range of each actuator where the scene has one, else its limits.
CommandBox command_box(const Scene& scene);

struct RandomCommands {
  CommandBox box;
  int rollouts = 0;         // > 0
  double duration_s = 0.0;  // of each
  double hold_s = 0.5;      // > 0, of each command
  unsigned seed = 1;
};

// Each rollout draws from a sequence of its own, so that fewer of them are the first of more. Throws
// std::invalid_argument for a number out of range, and for an actuator without limits.
std::vector<RolloutCommands> random_commands(const RandomCommands& random, const Model& model);

// Throws std::invalid_argument where a file of commands ends in neither .csv nor .npz.
void require_commands_ending(const std::string& file);

// .csv: columns `rollout` (0, 1, ... in order), `time_s` and any actuator by its name; an empty cell leaves the
// command. .npz: per actuator an array `rollouts x holds`, by its name, each command held for hold_s. Throws
// std::invalid_argument with file, line, name and value.
std::vector<RolloutCommands> read_commands_file(const std::string& file, double hold_s, const Model& model);

}  // namespace soft_robot_lab
