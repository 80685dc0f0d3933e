// SPDX-License-Identifier: BSD-3-Clause
// Training of a reduced model by the full one.
#pragma once

#include <memory>

#include "reduced_model.h"

namespace soft_robot_lab {

struct ReducedTraining {
  CommandBox box;                      // holds every actuator's rest command
  int modes = 20;                      // [1, 40] of displacement; fewer where the snapshots span fewer
  int ramps = 30;                      // [1, 1000] from rest to commands in the box, four equilibria each
  double transient_s = 10.0;           // [0, 600] of random commands by implicit Euler; 0: statics alone
  double cubature_tolerance_m = 5e-6;  // >= 0, rms displacement in one Newton step; 0 keeps every point
};

// The method: displacements and element multipliers by POD, polynomials exact in the reduced coordinates, and
// non-negative point weights chosen for their effect on displacements (energy-conserving sampling and weighting,
// Farhat et al. 2014, with rows of the inverse tangent in place of forces). Deterministic. Throws
// std::invalid_argument with field, value and range, and for a model with obstacles, skin that rubs, moving holds,
// viscosity, another material than neo_hookean, vertex-averaged volumes, or an actuator that ReducedConstraints does
// not know.
std::shared_ptr<const ReducedModel> train(const std::shared_ptr<const Model>& model, const ReducedTraining& training);

// The same from states that were collected with the same box, for several numbers of modes.
struct TrainingSet;
std::shared_ptr<const ReducedModel> train_on(const TrainingSet& set, const std::shared_ptr<const Model>& model,
                                             const ReducedTraining& training);

}  // namespace soft_robot_lab
