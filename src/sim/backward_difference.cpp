#include "backward_difference.h"

namespace soft_robot_lab {
namespace {

constexpr double kLargestGrowth = 2.0;  // of a time step over the one before; BDF2 is stable up to 1 + sqrt(2)

}  // namespace

BackwardDifference::BackwardDifference(const SimulationState& state, double h) {
  const double w = state.previous_step_s > 0.0 ? h / state.previous_step_s : 0.0;
  if (w == 0.0 || w > kLargestGrowth) {
    gamma_s = h;
    positions_from_m = state.positions_m;
    velocities_from_m_s = state.velocities_m_s;
    return;
  }
  const double one = (1.0 + w) * (1.0 + w) / (1.0 + 2.0 * w), two = w * w / (1.0 + 2.0 * w);
  gamma_s = h * (1.0 + w) / (1.0 + 2.0 * w);
  positions_from_m = one * state.positions_m - two * state.previous_positions_m;
  velocities_from_m_s = one * state.velocities_m_s - two * state.previous_velocities_m_s;
}

}  // namespace soft_robot_lab
