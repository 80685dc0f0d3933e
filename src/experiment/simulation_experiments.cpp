#include "experiment/cantilever_experiment.h"
#include "soft_robot_lab/experiment/experiment.h"

namespace soft_robot_lab {

std::vector<Experiment> simulation_experiments() {
  return {
      {"cantilever", "sag of a silicone bar over Poisson's ratio: which elements lock", run_cantilever_experiment},
  };
}

}  // namespace soft_robot_lab
