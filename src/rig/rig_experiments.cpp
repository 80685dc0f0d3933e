#include "soft_robot_lab/rig/rig_experiments.h"

#include "rig/fault_experiment.h"
#include "rig/pull_experiment.h"

namespace soft_robot_lab {

std::vector<Experiment> rig_experiments() {
  return {
      {"4.3.1", "how long the rig takes to pull 10 to 200 mm of cable", run_pull_experiment},
      {"rig_faults", "random commands over a bad line, with unplugging and resets: is the position ever wrong?",
       run_fault_experiment},
  };
}

}  // namespace soft_robot_lab
