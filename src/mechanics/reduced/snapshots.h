// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "reduced_model.h"
#include "reduced_newton.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// A state of the full model: at rest, or the end of a time step.
struct Snapshot {
  Eigen::VectorXd displacement_m, multipliers_pa, constraint_multipliers;
  DriveStates drives;
  double inertia_per_s2;
};

Snapshot snapshot_of(const Simulation& simulation, double inertia_per_s2);

Snapshot snapshot_of(const SimulationState& state, const Body& body, double inertia_per_s2);

// The model's unknowns nearest to a snapshot, by mass and by volume; skin pushes nothing.
ReducedUnknowns projected(const ReducedModel& model, const Snapshot& at);

// Commands number `i` of a sequence that fills the box evenly (Halton 1960).
std::vector<double> commands_in(const CommandBox& box, std::size_t i);

// Of the full or of the reduced model, in its order of actuators.
template <class AnySimulation>
void command(const std::vector<double>& commands, AnySimulation& simulation) {
  for (std::size_t a = 0; a < commands.size(); ++a)
    simulation.set_command(simulation.actuators()[a]->name(), commands[a]);
}

// New commands whenever this time has passed, of a sequence by `seed`.
constexpr double kTransientHold_s = 5.0 / 6.0;
std::vector<std::vector<double>> transient_commands(const CommandBox& box, double duration_s, unsigned seed);

// Moves the full model through them from its rest shape; calls `after_step(number, converged)` after each step.
template <class AfterStep>
void run_transient(const CommandBox& box, double duration_s, unsigned seed, Simulation& simulation,
                   const AfterStep& after_step) {
  const std::vector<std::vector<double>> targets = transient_commands(box, duration_s, seed);
  const double h = simulation.options().time_step_s;
  const int steps = static_cast<int>(std::lround(duration_s / h));
  simulation.reset();
  for (int i = 0; i < steps; ++i) {
    const auto hold = static_cast<std::size_t>(i * h / kTransientHold_s);
    command(targets[std::min(hold, targets.size() - 1)], simulation);
    after_step(i, simulation.step().converged);
  }
}

// Of the coordinates 3*node + axis.
Eigen::VectorXd masses_of_axes_kg(const Body& body);
const Eigen::VectorXd& element_volumes_m3(const Model& model);

}  // namespace soft_robot_lab
