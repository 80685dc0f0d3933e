// SPDX-License-Identifier: BSD-3-Clause
#include "rig_experiments.h"

#include "air_policy_experiment.h"
#include "ball_experiment.h"
#include "fault_experiment.h"
#include "fit_rig_experiment.h"
#include "gap_experiments.h"
#include "paths_experiment.h"
#include "pull_experiment.h"
#include "twin_experiment.h"

namespace soft_robot_lab {

std::vector<Experiment> rig_experiments() {
  return {
      {"4.3.1", "how long the rig takes to pull 10 to 200 mm of cable", run_pull_experiment},
      {"rig_faults", "random commands over a bad line, with unplugging and resets: is the position ever wrong?",
       run_fault_experiment},
      {"fit_rig", "Spinebot's model fitted to one recording of the emulated rig: are its hidden numbers found?",
       run_fit_rig_experiment},
      {"paths", "tips draw curves on the emulated rig: rest states, plans in time, feedback, learning",
       run_paths_experiment},
      {"6.4.1", "Hammerbot on the emulated rig beside its simulation", run_hammerbot_gap_experiment},
      {"6.4.2", "Spinebot on the emulated rig beside its simulation", run_spinebot_gap_experiment},
      {"6.4.3", "Bubblebot on an emulated rig of syringes beside its simulation", run_bubblebot_gap_experiment},
      {"twin", "emulated robots are pushed and hung with weights: what their fitted models make of it by markers",
       run_twin_experiment},
      {"air_policy", "Bubblebot reaches for places by three syringes: policies of the model on the emulated rig",
       run_air_policy_experiment},
      {"7.3.3", "Spinebot and the source's ball: policy, replay on the emulated rig, closed loop",
       run_source_ball_experiment},
      {"ball", "the same with the ball of the demonstration, and a place within reach", run_ball_experiment},
  };
}

}  // namespace soft_robot_lab
