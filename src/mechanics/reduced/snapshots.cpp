// SPDX-License-Identifier: BSD-3-Clause
#include "snapshots.h"

#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include "mechanics/elements/elements.h"
#include "mechanics/simulation/workspace.h"

namespace soft_robot_lab {
namespace {

constexpr std::array<int, 12> kPrimes{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};

double radical_inverse(std::size_t i, int base) {
  double value = 0.0, digit = 1.0 / base;
  for (const auto b = static_cast<std::size_t>(base); i > 0; i /= b, digit /= base)
    value += digit * static_cast<double>(i % b);
  return value;
}

}  // namespace

Snapshot snapshot_of(const Simulation& simulation, double inertia_per_s2) {
  return snapshot_of(simulation.state(), simulation.body(), inertia_per_s2);
}

Snapshot snapshot_of(const SimulationState& state, const Body& body, double inertia_per_s2) {
  const Eigen::Matrix3Xd moved = state.positions_m - body.mesh().nodes_m;
  return {Eigen::Map<const Eigen::VectorXd>(moved.data(), moved.size()), state.element_multipliers_pa,
          state.constraint_multipliers, state.drives, inertia_per_s2};
}

ReducedUnknowns projected(const ReducedModel& model, const Snapshot& at) {
  const Eigen::VectorXd masses_kg = masses_of_axes_kg(model.full->body());
  return {model.basis.modes.transpose() * masses_kg.cwiseProduct(at.displacement_m),
          model.basis.pressures.transpose() * element_volumes_m3(*model.full).cwiseProduct(at.multipliers_pa),
          at.constraint_multipliers, Eigen::VectorXd::Zero(model.skin.places())};
}

std::vector<double> commands_in(const CommandBox& box, std::size_t i) {
  if (box.min.size() > kPrimes.size()) throw std::invalid_argument("a reduced model takes at most 12 actuators");
  std::vector<double> commands;
  for (std::size_t a = 0; a < box.min.size(); ++a)
    commands.push_back(box.min[a] + (box.max[a] - box.min[a]) * radical_inverse(i + 1, kPrimes[a]));
  return commands;
}

std::vector<std::vector<double>> transient_commands(const CommandBox& box, double duration_s, unsigned seed) {
  std::mt19937 generator(seed);
  std::vector<std::vector<double>> targets(static_cast<std::size_t>(std::ceil(duration_s / kTransientHold_s)));
  for (std::vector<double>& target : targets)
    for (std::size_t a = 0; a < box.min.size(); ++a)
      target.push_back(box.min[a] + (box.max[a] - box.min[a]) * (generator() / 4294967296.0));
  return targets;
}

Eigen::VectorXd masses_of_axes_kg(const Body& body) {
  const Eigen::RowVectorXd masses = body.node_masses_kg().transpose();
  const Eigen::Matrix3Xd all = masses.replicate<3, 1>();
  return Eigen::Map<const Eigen::VectorXd>(all.data(), all.size());
}

const Eigen::VectorXd& element_volumes_m3(const Model& model) {
  return model.tables().newton->elements->rest_volumes_m3();
}

}  // namespace soft_robot_lab
