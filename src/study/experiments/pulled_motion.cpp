// SPDX-License-Identifier: BSD-3-Clause
#include "pulled_motion.h"

#include <stdexcept>

namespace soft_robot_lab {

std::vector<Moment> move_through(Simulation& simulation, const std::vector<CablePull>& pulls, double hold_s,
                                 double rate_hz) {
  const SolveReport rest = simulation.solve_equilibrium();
  if (!rest.converged) throw std::runtime_error("the robot's rest state was not found: " + rest.message);
  std::vector<Moment> moments;
  const int moments_a_pull = static_cast<int>(hold_s * rate_hz);
  for (const CablePull& pull : pulls) {
    simulation.set_command(simulation.actuators().at(0)->name(), pull.left);
    simulation.set_command(simulation.actuators().at(1)->name(), pull.right);
    for (int i = 0; i < moments_a_pull; ++i) {
      simulation.step();
      const SimulationState previous = simulation.state();
      simulation.step();
      moments.push_back({static_cast<double>(moments.size()) / rate_hz, previous, simulation.state()});
    }
  }
  return moments;
}

}  // namespace soft_robot_lab
