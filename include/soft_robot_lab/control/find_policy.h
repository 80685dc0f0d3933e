// SPDX-License-Identifier: BSD-3-Clause
// Finds a policy for a task: one pose of the markers after the other, each step from the state of the one before, so
// that the order of pulling counts where a body buckles or its cables have friction.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "optimiser.h"
#include "policy.h"

namespace soft_robot_lab {

struct ReducedChoice;

struct MarkerGoal {
  std::string marker;
  Eigen::Vector3d target_m = Eigen::Vector3d::Zero();  // robot_base
  double weight = 1.0;                                 // > 0
};

struct Pose {
  std::vector<MarkerGoal> goals;
  double duration_s = 2.0;  // > 0, from the pose before; bounds the change where there is a largest rate
  std::vector<std::string> actuators = {};  // that may move on the way here; empty: all
};

// Narrower than an actuator's own limits.
struct ActuatorBounds {
  std::string actuator;
  double min = 0.0;
  double max = 0.0;
  double max_tension_n = std::numeric_limits<double>::infinity();   // > 0
  double max_rate_per_s = std::numeric_limits<double>::infinity();  // > 0; of the command
};

struct PolicyTask {
  std::vector<Pose> poses;
  std::vector<ActuatorBounds> bounds = {};
  double effort_m = 0.0;  // as in ReachProblem
};

// What is odd about a valid task: a target so far from its marker that nobody can have meant metres. Empty where
// nothing is. Throws std::invalid_argument for an unknown marker.
std::vector<std::string> far_targets(const Simulation& simulation, const PolicyTask& task);

struct PolicyAnswer {
  bool success = false;                        // every pose has a usable summary
  CommandPolicy policy;                        // a step for each pose that has one
  std::vector<OptimisationSummary> summaries;  // one per pose, up to one that failed or was cancelled
  // Where a reduced model was handed in, per summary: empty, or why the full model searched in its place.
  std::vector<std::string> full_because;
};

// Where nobody says within which distance a target counts as reached, half a millimetre does: meshes and cameras know
// no better. A search goes on below it.
constexpr double kReached_m = 5.0e-4;
void count_as_reached(PolicyAnswer& answer);

// `pose` counts from 0.
using PoseProgress =
    std::function<bool(size_t pose, const std::vector<std::string>& actuators, const OptimisationProgress& progress)>;

// Starts at the simulation's present rest state and commands, and leaves it at the policy's end. Throws
// std::invalid_argument naming field, value and allowed range, before anything moves. With a reduced model of the
// simulation's every method searches on that one, and the answer is the full model's rest state at its end; where it
// does not serve, the full model searches.
PolicyAnswer find_policy(Simulation& simulation, const PolicyTask& task, const OptimiserOptions& options,
                         const PoseProgress& progress = {}, const ReducedChoice* reduced = nullptr);

}  // namespace soft_robot_lab
