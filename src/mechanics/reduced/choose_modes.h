// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <stdexcept>

#include "reduced_model.h"
#include "training_set.h"

namespace soft_robot_lab {

struct ReducedRequest {
  CommandBox box;               // holds every actuator's rest command
  bool may_narrow = false;      // towards the rest commands, where no model of all of it meets the tolerance
  double tolerance_m = 1e-4;    // > 0, of `largest_rms_m` of the outcome
  int modes = 0;                // [1, 40]; 0: the fewest that meet the tolerance
  double audit_every_s = 10.0;  // > 0, of motion: for whoever moves the model
};

struct ReducedChoice {
  std::shared_ptr<const ReducedModel> model;
  ReducedError equilibria, transient;  // on what it was not trained with
  double cpu_s = 0.0;                  // of training and judging

  // An estimate beyond it says that the model is not what was judged: twice the largest distance seen then.
  double trusted_m() const { return 2.0 * (equilibria.max_m > transient.max_m ? equilibria.max_m : transient.max_m); }
  double largest_rms_m() const { return equilibria.rms_m > transient.rms_m ? equilibria.rms_m : transient.rms_m; }
};

// No model of the box, or of the narrowest one that was tried, meets the tolerance.
class ToleranceNotMet : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

// Trains, and judges on 20 equilibria and 6 s of motion that training did not use. Deterministic but for cpu_s. Throws
// std::invalid_argument as train(), and ToleranceNotMet, with the error of the best.
ReducedChoice choose_modes(const std::shared_ptr<const Model>& model, const ReducedRequest& request,
                           const TrainingProgress& progress);

}  // namespace soft_robot_lab
