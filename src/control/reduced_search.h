// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "mechanics/reduced/choose_modes.h"
#include "reduced_forward_model.h"
#include "soft_robot_lab/control/find_policy.h"

namespace soft_robot_lab {

// A command that the training holds back, where the task would let it go on: empty, or which. `trained` has the bounds
// of `asked` cut to those trained; `slack` as Prediction has it.
std::string held_back(const ReachProblem& asked, const ReachProblem& trained, const Eigen::VectorXd& commands,
                      const Eigen::VectorXd& slack);

// Searches on a reduced model that end on the full one: the simulation takes over the shape found and comes to rest,
// the model is corrected by what its markers and derivatives are wrong by there, and the search goes on, until what is
// left of the way is short.
class ReducedSearch {
 public:
  ReducedSearch(Simulation& simulation, const ReducedChoice& reduced);

  // From the simulation's present rest state; leaves it at the answer. Where the model does not serve the simulation
  // stays as it was, the summary is not usable, and its stop_reason says why: another command than it was trained for,
  // a start or an end that is not the full model's, a way that has more than one end, or a failed audit.
  OptimisationSummary find(const Pose& pose, ReachProblem problem, const OptimiserOptions& options,
                           const ProgressCallback& progress);

 private:
  std::string search(const Pose& pose, ReachProblem problem, const OptimiserOptions& options,
                     const ProgressCallback& progress, OptimisationSummary& summary);
  // The full model at rest beside the reduced one at the search's end.
  std::string rest_beside(ReducedForwardModel& model, const std::vector<std::string>& markers,
                          OptimisationSummary& summary);
  // The reduced model takes over the markers and derivatives of the full one there, and the search goes on: until that
  // leads only a short way on.
  std::string refine(ReducedForwardModel& model, const std::vector<std::string>& markers, ReachProblem& trained,
                     const OptimiserOptions& options, const ProgressCallback& progress, OptimisationSummary& summary);
  std::string require_one_end(const SimulationState& start, const std::vector<std::string>& names,
                              const std::vector<std::string>& markers, const OptimisationSummary& summary,
                              ReducedForwardModel& model);

  Simulation& simulation_;
  const ReducedChoice& reduced_;
  double limit_m_;        // beyond which the model is not trusted
  SimulationState lack_;  // of the model against the full one where that rested: positions and multipliers alone
};

}  // namespace soft_robot_lab
