// SPDX-License-Identifier: BSD-3-Clause
// What a simulation is made of, for the parts of its solution: time_stepping, equilibrium, descent, substepping.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "mechanics/xpbd/xpbd_solver.h"
#include "mechanics/newton/newton_solver.h"
#include "soft_robot_lab/mechanics/actuator.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/marker.h"
#include "soft_robot_lab/mechanics/simulation_state.h"
#include "soft_robot_lab/mechanics/solve_report.h"
#include "soft_robot_lab/mechanics/solver_options.h"

namespace soft_robot_lab {

constexpr int kStageIterations = 25;  // Newton iterations before a step or stage is cut

struct SimulationParts {
  Body body;
  std::vector<std::unique_ptr<Actuator>> actuators;
  std::vector<Marker> markers;
  SolverOptions options;
  NewtonSolver solver;
  std::unique_ptr<XpbdSolver> xpbd;  // where it is the method
  SimulationState state;

  SimulationParts(Body body_in, std::vector<std::unique_ptr<Actuator>> actuators_in, std::vector<Marker> markers_in,
                  const SolverOptions& options_in);

  void reset();  // rest shape, rest commands, time zero

  NewtonState unknowns() const;
  void accept(NewtonState solved);

  // What actuators and solver know, so that a copy of the state has it; and back, but for the solver.
  void remember();
  void restore(const SimulationState& saved);
  void forget_previous_step();
  void forget_motion();  // velocities, the step before, and the stress of hysteresis: a body long at rest

  std::vector<double> multipliers_of(std::size_t actuator) const;  // its constraints' multipliers

  // Passes to the actuators from where a step starts, or with an infinite one an equilibrium.
  void begin_step(double time_step_s = std::numeric_limits<double>::infinity());

  // The actuated commands: this share of the way from `from` to the commands.
  void move_actuators(const std::vector<double>& from, double fraction);

  // Solves from the present state, which it leaves alone; the report counts the work and says how this solve ended.
  NewtonReport solve(const NewtonTask& task, NewtonState& unknown, SolveReport& report);

  // The same after a descent down the energy from the present state (NewtonSolver::descend), for where Newton finds no
  // way. Where it does not converge either, `unknown` is where the descent ended. With friction there is no descent,
  // and `unknown` stays.
  NewtonReport solve_from_below(const NewtonTask& task, NewtonState& unknown, SolveReport& report);
};

}  // namespace soft_robot_lab
