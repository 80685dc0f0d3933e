// SPDX-License-Identifier: BSD-3-Clause
// What a simulation is made of, for the parts of its solution: time_stepping, equilibrium, descent, substepping.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "soft_robot_lab/mechanics/model.h"
#include "soft_robot_lab/mechanics/simulation_state.h"
#include "soft_robot_lab/mechanics/solve_report.h"
#include "energy_keeper.h"
#include "workspace.h"

namespace soft_robot_lab {

struct SimulationParts {
  std::shared_ptr<const Model> model;
  const Body& body;  // these are the model's
  const std::vector<std::unique_ptr<const Actuator>>& actuators;
  const std::vector<Marker>& markers;
  const SolverOptions& options;

  Workspace workspace;
  SimulationState state;
  std::optional<EnergyKeeper> energy;

  explicit SimulationParts(std::shared_ptr<const Model> model_in);

  void reset();  // rest shape, rest commands, time zero

  NewtonState unknowns() const;  // of the present state and its drives
  void accept(NewtonState solved);

  void set_state(const SimulationState& saved);  // fills in what a state may leave empty
  void forget_previous_step();
  void forget_motion();  // velocities, the step before, and the stress of hysteresis: a body long at rest

  std::vector<double> multipliers_of(std::size_t actuator) const;  // its constraints' multipliers
  ActuatorReading reading_of(std::size_t actuator) const;

  // Passes to the actuators from where a step starts, or with an infinite one an equilibrium.
  void begin_step(double time_step_s = std::numeric_limits<double>::infinity());
  // The unknowns for a question about the present state that leaves it as it is, memories and all.
  NewtonState unknowns_at_step(double time_step_s = std::numeric_limits<double>::infinity()) const;

  void advance_actuators(double time_step_s);  // towards their commands, as far as their drives come
  // Their actuated commands, this share of the way from `from` to `to`.
  void place_actuators(const std::vector<double>& from, const std::vector<double>& to, double fraction);

  // Runs a solve that may be interrupted; then all is as it was, false, and the report says so.
  bool solve_or_go_back(const std::function<void(SolveReport&)>& solve, SolveReport& report);

  // Solves from the present state, which it leaves alone; the report counts the work and says how this solve ended.
  NewtonReport solve(const NewtonTask& task, NewtonState& unknown, SolveReport& report);

  // The same after a descent down the energy from the present state (NewtonSolver::descend), for where Newton finds no
  // way. Where it does not converge either, `unknown` is where the descent ended. With friction there is no descent,
  // and `unknown` stays.
  NewtonReport solve_from_below(const NewtonTask& task, NewtonState& unknown, SolveReport& report);
};

}  // namespace soft_robot_lab
