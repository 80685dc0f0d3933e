// SPDX-License-Identifier: BSD-3-Clause
// Training of a reduced model by the full one, and its error on what it was not trained with.
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
// std::invalid_argument with field, value and range, and for a model with contact, viscosity, another material than
// neo_hookean, vertex-averaged volumes, or an actuator that is no frictionless cable.
std::shared_ptr<const ReducedModel> train(const std::shared_ptr<const Model>& model, const ReducedTraining& training);

// At `count` commands in the box that training did not use, each from rest.
ReducedError held_out_equilibria(const std::shared_ptr<const ReducedModel>& reduced, int count);

// Of the best shapes that the modes hold, over the same transient as below: no equations of motion do better.
ReducedError held_out_projection(const std::shared_ptr<const ReducedModel>& reduced, double duration_s);

// Over a transient that training did not use.
ReducedError held_out_transient(const std::shared_ptr<const ReducedModel>& reduced, double duration_s);

}  // namespace soft_robot_lab
