// SPDX-License-Identifier: BSD-3-Clause
#include "pose_walk.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace soft_robot_lab {
namespace {

constexpr int kStagesOfMove = 4;   // where friction makes the way count
constexpr int kFinestStages = 64;  // where one of them is too far for the solver

std::vector<double> between(const std::vector<double>& from, const std::vector<double>& to, double fraction) {
  std::vector<double> there(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) there[i] = from[i] + fraction * (to[i] - from[i]);
  return there;
}

}  // namespace

bool has_friction(const Simulation& simulation) {
  return std::any_of(simulation.actuators().begin(), simulation.actuators().end(),
                     [](const auto& actuator) { return !actuator->friction_contacts().empty(); });
}

PoseWalk::PoseWalk(Simulation& simulation, std::vector<ModelParameter> parameters, bool derivatives)
    : simulation_(simulation),
      derivatives_(derivatives),
      friction_(has_friction(simulation)),
      past_{{}, PoseSensitivities(std::move(parameters))} {}

void PoseWalk::go(const DriveEnds& end) {
  const std::vector<double> from = simulation_.state().commands(), &to = end.commands;
  const std::vector<double> slopes_before = std::exchange(past_.slopes, end.slopes);
  if (!friction_) {
    solve(from, to, 1.0);
    past_.sensitivities.forget();
    differentiate(past_.slopes);
    return;
  }
  // Each stage one solve, as length slips within each: derivatives follow every one.
  const double longest = from == to ? 1.0 : 1.0 / kStagesOfMove;
  double done = 0.0, stage = longest;
  while (done < 1.0 - 1e-9) {
    const SimulationState before = simulation_.state();
    const bool in_one = solve(from, to, done + stage) == 1;
    if (!in_one && stage * kFinestStages > 1.0) {
      simulation_.set_state(before);
      stage *= 0.5;
      continue;
    }
    done += stage;
    differentiate(between(slopes_before.empty() ? past_.slopes : slopes_before, past_.slopes, done));
    stage = std::min({longest, 2.0 * stage, 1.0 - done});
  }
}

void PoseWalk::go_back(const SimulationState& state, const Past& past) {
  simulation_.set_state(state);
  past_ = past;
}

int PoseWalk::solve(const std::vector<double>& from, const std::vector<double>& to, double fraction) {
  const std::vector<double> there = fraction >= 1.0 - 1e-9 ? to : between(from, to, fraction);
  for (std::size_t i = 0; i < to.size(); ++i) simulation_.set_command(simulation_.actuators()[i]->name(), there[i]);
  const SolveReport report = simulation_.solve_equilibrium();
  if (!report.converged) throw std::runtime_error(report.message);
  return report.steps;
}

void PoseWalk::differentiate(const std::vector<double>& slopes) {
  if (derivatives_) past_.sensitivities.update(simulation_, slopes);
}

}  // namespace soft_robot_lab
