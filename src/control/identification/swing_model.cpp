// SPDX-License-Identifier: BSD-3-Clause
#include "swing_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "simulated_now.h"

namespace soft_robot_lab {
namespace {

void command(Simulation& simulation, const std::string& name, double value) {
  const CommandLimits limits =
      simulation.actuators()[static_cast<std::size_t>(simulation.actuator_index(name))]->limits();
  simulation.set_command(name, std::clamp(value, limits.min, limits.max));
}

// By a drive on its way; a slack cable moves nothing.
bool moved(const Simulation& simulation) {
  for (std::size_t i = 0; i < simulation.actuators().size(); ++i) {
    const DriveState& drive = simulation.state().drives[i];
    if (!arrived(drive) && simulation.actuator_state(static_cast<int>(i)).tension_n != 0.0) return true;
  }
  return false;
}

SimulatedSwing simulate(Simulation& simulation, const MeasuredSwing& swing, double window_s) {
  simulation.reset();
  for (const auto& [name, value] : swing.from) command(simulation, name, value);
  const SolveReport rest = simulation.solve_equilibrium();
  if (!rest.converged) throw std::runtime_error("a swing starts from no rest: " + rest.message);
  const double start_s = swing.commands.front().time_s, step_s = simulation.options().time_step_s;
  double free_s = start_s;
  std::vector<Eigen::Matrix3Xd> markers_m = {places(simulation)};
  std::size_t next = 0;
  for (double time_s = start_s; time_s < free_s + window_s; time_s += step_s) {
    for (; next < swing.commands.size() && swing.commands[next].time_s <= time_s; ++next)
      for (const auto& [name, value] : swing.commands[next].commands) command(simulation, name, value);
    if (simulation.step().interrupted) throw std::runtime_error("a swing was interrupted");
    markers_m.push_back(places(simulation));
    if (next < swing.commands.size() || moved(simulation)) free_s = time_s + step_s;
  }
  return {start_s, step_s, free_s, std::move(markers_m)};
}

}  // namespace

// With u from 0 to 1 between the two in the middle.
Eigen::Vector3d SimulatedSwing::cubic(int marker, double time_s, bool derivative) const {
  const double last = static_cast<double>(markers_m_.size() - 1);
  const double at = std::clamp((time_s - start_s_) / step_s_, 0.0, last);
  const auto one = static_cast<std::size_t>(std::min(std::floor(at), last - 1.0));
  const double u = at - static_cast<double>(one);
  const auto place = [&](std::size_t i) -> Eigen::Vector3d { return markers_m_[i].col(marker); };
  const Eigen::Vector3d b = place(one), c = place(one + 1);
  const Eigen::Vector3d a = one > 0 ? place(one - 1) : b, d = one + 2 < markers_m_.size() ? place(one + 2) : c;
  const Eigen::Vector3d linear = 0.5 * (c - a), square = a - 2.5 * b + 2.0 * c - 0.5 * d,
                        cube = 0.5 * (d - a) + 1.5 * (b - c);
  if (derivative) return (linear + u * (2.0 * square + 3.0 * u * cube)) / step_s_;
  return b + u * (linear + u * (square + u * cube));
}

Eigen::Vector3d SimulatedSwing::deflection_m(int marker, double time_s) const {
  return cubic(marker, time_s, false) - markers_m_.back().col(marker);
}

Eigen::Vector3d SimulatedSwing::velocity_m_s(int marker, double time_s) const { return cubic(marker, time_s, true); }

std::vector<SimulatedSwing> simulate_swings(Simulation& simulation, const std::vector<MeasuredSwing>& swings,
                                            double window_s) {
  std::vector<SimulatedSwing> all;
  for (const MeasuredSwing& swing : swings) all.push_back(simulate(simulation, swing, window_s));
  return all;
}

}  // namespace soft_robot_lab
