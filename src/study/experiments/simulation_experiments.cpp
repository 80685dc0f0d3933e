// SPDX-License-Identifier: BSD-3-Clause
#include "cable_experiments.h"
#include "cantilever_experiment.h"
#include "chamber_experiments.h"
#include "demoulding_experiment.h"
#include "design_experiment.h"
#include "fit_experiment.h"
#include "grasp_experiment.h"
#include "policy_experiments.h"
#include "rest_states_experiment.h"
#include "tentacle_experiment.h"
#include "vision_experiments.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "study/experiment.h"

namespace soft_robot_lab {

SceneOptions ExperimentContext::scene_options(const Overrides& overrides) const {
  SceneOptions options;
  options.mesher = mesher;
  options.actuator_factory = make_actuator;
  options.overrides = overrides;
  return options;
}

std::vector<Experiment> simulation_experiments() {
  return {
      {"cantilever", "sag of a silicone bar over Poisson's ratio: which elements lock", run_cantilever_experiment},
      {"rest_states", "rest states reached in time against the equilibrium, by every solver and over time steps",
       run_rest_states_experiment},
      {"3.3.1", "five markers found by contrast in 60 images of Spinebot", run_contrast_segmentation_experiment},
      {"3.3.2", "a red marker at the tip found by its colour in 60 images", run_colour_segmentation_experiment},
      {"4.3.2", "stiffness of the cable on the hanging bar: final length and oscillation",
       run_cable_stiffness_experiment},
      {"5.3.1", "inflation of the hollow cuboid: volume and pressure in time and over gas", run_inflation_experiment},
      {"5.3.2", "deflation of the hollow cuboid: volume and pressure in time and over gas", run_deflation_experiment},
      {"6.3.1", "Hammerbot through the source's table of contractions, one after the other",
       run_hammerbot_configurations_experiment},
      {"6.3.2", "Spinebot through the source's table of contractions, one after the other",
       run_spinebot_configurations_experiment},
      {"6.3.3", "Spinebot and Hammerbot pulled left first, right first, both at once, and the ways they buckle",
       run_pull_order_experiment},
      {"6.3.4", "Bubblefinger inflated without gravity, on a coarse and a fine mesh", run_bubblefinger_experiment},
      {"6.3.5", "a chamber of Bubblebot inflated to beta 5, at rest and in time, and the elements' quality",
       run_bubblebot_experiment},
      {"via_points", "how many via points a cable needs, in a bar held at both ends", run_via_points_experiment},
      {"pseudo_inverse", "what the source's coupling of cable and mesh does to the force",
       run_pseudo_inverse_experiment},
      {"workspace_hammerbot", "where Hammerbot rests over all pairs of contractions of its cables",
       run_hammerbot_workspace_experiment},
      {"workspace_spinebot", "where Spinebot rests over all pairs of contractions of its cables",
       run_spinebot_workspace_experiment},
      {"tracking", "Spinebot tracked by two rendered cameras: exact, as a D415's, blurred, in poor light",
       run_tracking_experiment},
      {"7.3.1", "ten random targets for Hammerbot, all methods", run_random_targets_experiment},
      {"7.3.2", "PID as published on the same ten targets, descent beside it", run_pid_experiment},
      {"fit", "Spinebot's model fitted to its table of contractions, and tried on poses it has not seen",
       run_fit_experiment},
      {"demoulding",
       "castable Bubblebot and Hammerbot pulled out of their moulds: force, stretch, with and without air holes",
       run_demoulding_experiment},
      {"grasp", "the gripper lifts a ball and is shaken, over the friction of its fingers", run_grasp_experiment},
      {"design_spinebot", "castable designs of Spinebot that reach farther, and the mould of the best one",
       run_design_spinebot_experiment},
      {"tentacle", "a measured tentacle: distances at published materials, and fitted on every other pose",
       run_tentacle_experiment},
  };
}

}  // namespace soft_robot_lab
