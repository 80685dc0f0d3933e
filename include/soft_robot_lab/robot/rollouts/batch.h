// SPDX-License-Identifier: BSD-3-Clause
// Many runs of one scene, on several threads: for learning, searches and statistics.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "soft_robot_lab/mechanics/model.h"
#include "soft_robot_lab/robot/scene/run_scene.h"
#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

using RolloutCommands = std::vector<TimedCommands>;  // in order of time

struct RolloutPlan {
  double duration_s = 10.0;               // > 0
  double record_every_s = 0.0;            // >= 0; 0 records every step
  std::vector<RolloutCommands> rollouts;  // each from the rest shape
};

// One model, which all threads share; a state and a workspace for each thread. A scene with a reduced model runs on
// that one, as run_scene does: on what it does not know newton goes on, with a warning in the report.
class RolloutBatch {
 public:
  explicit RolloutBatch(const Scene& scene);

  // How many rollouts have ended; false starts no more. Called by one thread at a time.
  using Progress = std::function<bool(std::size_t ended)>;

  // A report per rollout, in their order: to the last bit those of one thread (but wall_s), however many threads there
  // are. One that was not started, or not run to its end, has an empty trajectory; `ends` may ask for that at any time,
  // in any thread. Throws std::invalid_argument for a number out of range and
  // for a command that an actuator refuses, before anything moves.
  std::vector<RunReport> run(const RolloutPlan& plan, int threads, const Progress& progress = {},
                             const std::function<bool()>& ends = {}) const;

 private:
  void require_valid(const RolloutPlan& plan, int threads) const;

  std::shared_ptr<const Model> model_;
  std::shared_ptr<const SceneReduction> reduction_;  // may be null
};

}  // namespace soft_robot_lab
