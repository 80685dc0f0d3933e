// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "reduced_model.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// A state of the full model: at rest, or the end of a time step.
struct Snapshot {
  Eigen::VectorXd displacement_m, multipliers_pa, tensions_n;
  DriveStates drives;
  double inertia_per_s2;
};

Snapshot snapshot_of(const Simulation& simulation, double inertia_per_s2);

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

}  // namespace soft_robot_lab
