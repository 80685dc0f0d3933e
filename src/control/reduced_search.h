// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "mechanics/reduced/choose_modes.h"
#include "reduced_forward_model.h"
#include "soft_robot_lab/control/find_policy.h"

namespace soft_robot_lab {

// Searches on a reduced model that end on the full one: the search's end is audited, the model is corrected by what the
// audit says that markers and derivatives are wrong by there, the search goes on, and the simulation takes over the
// shape found and comes to rest.
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
  std::string correct(ReducedForwardModel& model, ReachProblem& trained, const OptimiserOptions& options,
                      const ProgressCallback& progress, OptimisationSummary& summary);
  std::string require_one_end(const std::vector<double>& start, const OptimisationSummary& summary,
                              ReducedForwardModel& model) const;
  std::string settle(const ReducedForwardModel& model, const std::vector<std::string>& markers,
                     OptimisationSummary& summary);

  Simulation& simulation_;
  const ReducedChoice& reduced_;
  Audit audit_;
  double limit_m_;        // beyond which the model is not trusted
  SimulationState lack_;  // of the model against the full one at the audit: positions and multipliers alone
};

}  // namespace soft_robot_lab
