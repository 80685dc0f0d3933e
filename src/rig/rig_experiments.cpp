#include "soft_robot_lab/rig/rig_experiments.h"

#include "rig/ball_experiment.h"
#include "rig/fault_experiment.h"
#include "rig/gap_experiments.h"
#include "rig/pull_experiment.h"

namespace soft_robot_lab {

std::vector<Experiment> rig_experiments() {
  return {
      {"4.3.1", "how long the rig takes to pull 10 to 200 mm of cable", run_pull_experiment},
      {"rig_faults", "random commands over a bad line, with unplugging and resets: is the position ever wrong?",
       run_fault_experiment},
      {"6.4.1", "Hammerbot on the emulated rig beside its simulation", run_hammerbot_gap_experiment},
      {"6.4.2", "Spinebot on the emulated rig beside its simulation", run_spinebot_gap_experiment},
      {"7.3.3", "Spinebot and the source's ball: policy, replay on the emulated rig, closed loop",
       run_source_ball_experiment},
      {"ball", "the same with the ball of the demonstration, and a place within reach", run_ball_experiment},
  };
}

}  // namespace soft_robot_lab
