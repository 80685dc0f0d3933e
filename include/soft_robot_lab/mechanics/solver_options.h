// SPDX-License-Identifier: BSD-3-Clause
// How a simulation is solved.
#pragma once

#include <limits>

namespace soft_robot_lab {

enum class Integrator {
  implicit_euler,  // first order, damps
  bdf2,            // second order, damps little; the first step after a start or an equilibrium is implicit Euler
  tr_bdf2          // second order in two stages, a sixth of bdf2's error at twice its cost, and damps next to nothing
};

struct SolverOptions {
  // newton: Newton on everything at once. xpbd: XPBD, one element after another in substeps; for comparison and
  // for large meshes.
  enum class Method { newton, xpbd };
  Method method = Method::newton;
  Integrator integrator = Integrator::implicit_euler;  // xpbd knows no other
  double time_step_s = 1.0 / 60.0;                     // (0, 1]
  double tolerance = 1.0e-6;                           // (0, 1); force residual over the largest force in the body
  int max_iterations = 60;                             // [1, 10000] Newton iterations a step, or a continuation stage
  double dynamic_tolerance = 1.0e-3;  // (0, 1); the same for a time step, whose error the next step sees
  int substep_count = 20;             // [1, 10000] of xpbd, a time step; an equilibrium has its own
  int iteration_count = 1;            // [1, 10000] of xpbd: sweeps over all elements, a substep
  // > 0, wall time of a time step or an equilibrium, after which it ends as if interrupted; not for runs that are to be
  // repeated to the last bit.
  double time_limit_s = std::numeric_limits<double>::infinity();
  void validate() const;  // throws std::invalid_argument: field, value, allowed range
};

// Of method newton, for who asks for many equilibria of which few count; xpbd has no use for them.
struct EquilibriumOptions {
  double tolerance = 0.0;            // of the residual, where it is above SolverOptions::tolerance
  bool only_through_stable = false;  // give up, unconverged, where the body would buckle on the way
  bool warns_of_left_out = true;     // of skin and cables in other silicone, where the scene knows no contact there
};

}  // namespace soft_robot_lab
