// SPDX-License-Identifier: BSD-3-Clause
#include "energy_keeper.h"

#include <algorithm>
#include <cmath>

#include "mechanics/state/free_stepping.h"
#include "simulation_parts.h"

namespace soft_robot_lab {
namespace {

double work_j(const Eigen::Matrix3Xd& forces_n, const Eigen::Matrix3Xd& way_m) {
  return forces_n.cwiseProduct(way_m).sum();
}

// That cables' friction takes by the state's slips.
double slipped_j(const NewtonTables& tables, const NewtonState& state) {
  double sum_j = 0.0;
  for (std::size_t j = 0; j < tables.shared.size(); ++j)
    sum_j += state.slips_m[static_cast<Eigen::Index>(j)] * (state.constraint_multipliers[tables.shared[j].first] -
                                                            state.constraint_multipliers[tables.shared[j].second]);
  return sum_j;
}

}  // namespace

EnergyKeeper::EnergyKeeper(const SimulationParts& parts) {
  for (std::size_t i = 0; i < parts.actuators.size(); ++i) {
    const ActuatorReading reading =
        parts.actuators[i]->observe(parts.state.positions_m, parts.multipliers_of(i), parts.state.drives[i]);
    gas_.insert(gas_.end(), parts.actuators[i]->constraints().size(), reading.gauge_pressure_pa.has_value());
  }
  const SimulationState& now = parts.state;
  take_stock(parts, {now.positions_m, now.velocities_m_s, now.contact.free, now.free_velocities},
             parts.workspace.newton.energies().elastic_energy_j(now.positions_m));
  start_j_ = stored_j();
}

void EnergyKeeper::take_stock(const SimulationParts& parts, Motion at, double elastic_j) {
  const Body& body = parts.body;
  const FreeObstacles& free = parts.workspace.newton.contact().free();
  known_ = std::move(at);
  const auto moved_m = known_.positions_m - body.mesh().nodes_m;
  ledger_.kinetic_j = 0.5 * body.node_masses_kg().dot(known_.velocities_m_s.colwise().squaredNorm().transpose());
  ledger_.elastic_j = elastic_j;
  ledger_.loads_j = -body.dead_loads_n().cwiseProduct(moved_m).sum();
  ledger_.gravity_j = -parts.workspace.newton.energies().loads.all_n().cwiseProduct(moved_m).sum() - ledger_.loads_j;
  if (free.count() == 0) return;
  ledger_.kinetic_j += free_kinetic_j(free, known_.free, known_.free_velocities);
  FreeColumns weights = FreeColumns::Zero(3, 2 * free.count());
  ledger_.gravity_j += add_free_gradient(free, known_.free, nullptr, weights);
}

void EnergyKeeper::notice_rescue(const SimulationParts& parts, const SimulationState& now) {
  if (now.positions_m == known_.positions_m && now.velocities_m_s == known_.velocities_m_s &&
      now.contact.free == known_.free && now.free_velocities == known_.free_velocities)
    return;
  const double known_j = stored_j();
  const double elastic_j = now.positions_m == known_.positions_m
                               ? ledger_.elastic_j
                               : parts.workspace.newton.energies().elastic_energy_j(now.positions_m);
  take_stock(parts, {now.positions_m, now.velocities_m_s, now.contact.free, now.free_velocities}, elastic_j);
  ledger_.rescues_j += stored_j() - known_j;
  reactions_n_.resize(3, 0);
  damping_n_.resize(3, 0);
}

double EnergyKeeper::damped_j(const StepEnd& end, const Eigen::Matrix3Xd& way_m) const {
  const double at_end_j = end.work.viscous_j + end.drag_j;
  return end.trapezoidal && damping_n_.cols() > 0 ? 0.5 * (at_end_j + work_j(damping_n_, way_m)) : at_end_j;
}

void EnergyKeeper::add_step(const SimulationParts& parts, const SimulationState& before, StepEnd end,
                            const NewtonState& state, const SimulationState& after) {
  notice_rescue(parts, before);
  const EnergyLedger old = ledger_;
  take_stock(parts, {state.positions_m, after.velocities_m_s, state.contact.free, after.free_velocities},
             end.work.elastic_energy_j);
  const Eigen::Matrix3Xd way_m = state.positions_m - before.positions_m;
  const double material_j = damped_j(end, way_m);
  ledger_.material_j += material_j;
  double rule_j = end.inertia_j - (ledger_.kinetic_j - old.kinetic_j) + end.work.elastic_j -
                  (ledger_.elastic_j - old.elastic_j) + (end.work.viscous_j + end.drag_j - material_j);
  for (std::size_t i = 0; i < end.work.values.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const double change =
        end.work.values[i] - parts.workspace.newton.tables().constraints[i].value(before.positions_m, state.drives);
    const double taken_j = 0.5 * (before.constraint_multipliers[index] + state.constraint_multipliers[index]) * change;
    (gas_[i] ? ledger_.gas_j : ledger_.actuators_j) -= taken_j;
    rule_j += end.work.pulls_j[i] - taken_j;
  }
  ledger_.actuators_j -= end.work.driven_j;
  const double capstans_j = slipped_j(parts.workspace.newton.tables(), state);
  ledger_.actuators_j += capstans_j;
  ledger_.friction_j += capstans_j + end.work.rubbed_j;
  ledger_.obstacles_j += end.work.rubbed_j - end.work.contact_j;
  if (end.work.reactions_n.cols() > 0) {
    const double held_j = work_j(end.work.reactions_n, way_m);
    const double holds_j = reactions_n_.cols() > 0 ? 0.5 * (held_j + work_j(reactions_n_, way_m)) : held_j;
    ledger_.holds_j += holds_j;
    rule_j -= held_j - holds_j;
  }
  ledger_.integrator_j += rule_j;
  ledger_.closure_error_j = stored_j() - start_j_ - ledger_.actuators_j - ledger_.gas_j - ledger_.holds_j -
                            ledger_.obstacles_j - ledger_.rescues_j + ledger_.material_j + ledger_.friction_j +
                            ledger_.integrator_j;
  for (const auto kind :
       {&EnergyLedger::kinetic_j, &EnergyLedger::elastic_j, &EnergyLedger::gravity_j, &EnergyLedger::loads_j,
        &EnergyLedger::actuators_j, &EnergyLedger::gas_j, &EnergyLedger::holds_j, &EnergyLedger::obstacles_j,
        &EnergyLedger::material_j, &EnergyLedger::friction_j})
    ledger_.turned_over_j += 0.5 * std::abs(ledger_.*kind - old.*kind);
  reactions_n_ = std::move(end.work.reactions_n);
  damping_n_ = std::move(end.damping_n);
}

}  // namespace soft_robot_lab
