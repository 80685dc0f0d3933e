#include "experiment/cable_experiments.h"
#include "experiment/cantilever_experiment.h"
#include "experiment/chamber_experiments.h"
#include "experiment/fit_experiment.h"
#include "experiment/policy_experiments.h"
#include "experiment/rest_states_experiment.h"
#include "experiment/tentacle_experiment.h"
#include "experiment/vision_experiments.h"
#include "soft_robot_lab/actuators/factory.h"
#include "soft_robot_lab/experiment/experiment.h"

namespace soft_robot_lab {

SceneOptions ExperimentContext::scene_options(const std::string& changes) const {
  SceneOptions options;
  options.mesher = mesher;
  options.actuator_factory = make_actuator;
  options.changes = changes;
  return options;
}

std::vector<Experiment> simulation_experiments() {
  return {
      {"cantilever", "sag of a silicone bar over Poisson's ratio: which elements lock", run_cantilever_experiment},
      {"rest_states", "rest states reached in time against the equilibrium, by every solver and over time steps",
       run_rest_states_experiment},
      {"3.3.1", "markers found by contrast and by colour on the hanging Spinebot", run_segmentation_at_rest_experiment},
      {"3.3.2", "markers found by contrast and by colour on the moving Spinebot",
       run_segmentation_in_motion_experiment},
      {"4.3.2", "stiffness of the cable on the hanging bar: final length and oscillation",
       run_cable_stiffness_experiment},
      {"5.3.1", "inflation of the hollow cuboid: volume and pressure over gas", run_inflation_experiment},
      {"5.3.2", "deflation of the hollow cuboid: volume and pressure over gas", run_deflation_experiment},
      {"6.3.1", "where Hammerbot rests over the contractions of its cables", run_hammerbot_contractions_experiment},
      {"6.3.2", "where Spinebot rests over the contractions of its cables", run_spinebot_contractions_experiment},
      {"6.3.3", "Hammerbot pulled left first, right first, both at once, and the two ways it buckles",
       run_pull_order_experiment},
      {"6.3.4", "Bubblefinger inflated to beta 2.57, on a coarse and a fine mesh", run_bubblefinger_experiment},
      {"6.3.5", "a chamber of Bubblebot inflated to beta 5, and what the elements go through",
       run_bubblebot_experiment},
      {"tracking", "Spinebot tracked by two rendered cameras: exact, as a D415's, blurred, in poor light",
       run_tracking_experiment},
      {"7.3.1", "ten random targets for Hammerbot, all methods", run_random_targets_experiment},
      {"7.3.2", "PID as published on the same ten targets, descent beside it", run_pid_experiment},
      {"fit", "Spinebot's model fitted to its table of contractions, and tried on poses it has not seen",
       run_fit_experiment},
      {"tentacle", "a measured tentacle: distances at published materials, and fitted on every other pose",
       run_tentacle_experiment},
  };
}

}  // namespace soft_robot_lab
