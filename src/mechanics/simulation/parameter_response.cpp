// SPDX-License-Identifier: BSD-3-Clause
#include "parameter_response.h"

#include <stdexcept>

#include "rest.h"

namespace soft_robot_lab {
namespace {

void add_law_change(const SimulationParts& parts, const NewtonState& state, const std::string& key,
                    std::size_t actuator, Eigen::Index column, NewtonDrive& drive) {
  const Actuator& chosen = *parts.actuators.at(actuator);
  Eigen::Index constraint = 0, contact = 0;
  for (std::size_t i = 0; i < actuator; ++i) {
    constraint += static_cast<Eigen::Index>(parts.actuators[i]->constraints().size());
    contact += static_cast<Eigen::Index>(parts.actuators[i]->friction_contacts().size());
  }
  const std::optional<LawChange> change =
      chosen.law_change(key, parts.state.positions_m, parts.multipliers_of(actuator), state.drives->at(actuator));
  if (!change) throw std::invalid_argument("actuator '" + chosen.name() + "': nothing follows from its " + key);
  drive.offsets.col(column).segment(constraint, change->offsets.size()) += change->offsets;
  drive.log_ratios.col(column).segment(contact, change->log_ratios.size()) += change->log_ratios;
}

// What slipped so far, the first of two constraints holds more and the second less.
void add_slipped(const SimulationParts& parts, const Eigen::MatrixXd& slipped_m, NewtonDrive& drive) {
  Eigen::Index constraint = 0, row = 0;
  for (const auto& actuator : parts.actuators) {
    for (const FrictionContact* contact : actuator->friction_contacts()) {
      drive.offsets.row(constraint + contact->first) -= slipped_m.row(row);
      drive.offsets.row(constraint + contact->second) += slipped_m.row(row);
      ++row;
    }
    constraint += static_cast<Eigen::Index>(actuator->constraints().size());
  }
}

// What the residual force gains by a unit of density.
Eigen::VectorXd weight_n(const Body& body) {
  const Eigen::RowVectorXd shares_m3 = body.own_weights_kg().transpose() / body.material().density_kg_m3;
  Eigen::Matrix3Xd weight_n = -body.gravity_m_s2() * shares_m3;
  weight_n = body.fixed().array().select(0.0, weight_n.array()).matrix();
  return Eigen::Map<const Eigen::VectorXd>(weight_n.data(), weight_n.size());
}

Eigen::VectorXd force_of_body(const SimulationParts& parts, const NewtonState& state, const std::string& key) {
  if (key == "density_kg_m3") return weight_n(parts.body);
  return parts.workspace.newton.elastic_force_n(state) / parts.body.material().youngs_modulus_pa;
}

}  // namespace

Eigen::MatrixXd parameter_motions(SimulationParts& parts, const std::vector<ModelParameter>& parameters,
                                  Eigen::MatrixXd& slipped_m) {
  require_rest(parts);
  const auto columns = static_cast<Eigen::Index>(parameters.size());
  const NewtonState state = parts.unknowns_at_step();
  NewtonSolver& solver = parts.workspace.newton;
  NewtonDrive drive{Eigen::MatrixXd::Zero(state.positions_m.size(), columns),
                    Eigen::MatrixXd::Zero(solver.tables().constraint_count(), columns),
                    Eigen::MatrixXd::Zero(solver.tables().constraint_count(), columns),
                    Eigen::MatrixXd::Zero(solver.tables().friction_contact_count(), columns)};
  if (slipped_m.size() == 0) slipped_m = drive.log_ratios;
  for (Eigen::Index column = 0; column < columns; ++column) {
    const ModelParameter& parameter = parameters[static_cast<std::size_t>(column)];
    if (parameter.actuators.empty()) drive.forces_n.col(column) = force_of_body(parts, state, parameter.key);
    for (const int actuator : parameter.actuators)
      add_law_change(parts, state, parameter.key, static_cast<std::size_t>(actuator), column, drive);
  }
  add_slipped(parts, slipped_m, drive);
  const NewtonResponse response = solver.respond(state, drive);
  if (!response.stable) throw std::runtime_error("no sensitivity: the present state is not a stable equilibrium");
  slipped_m += response.slips_m;
  return response.motions_m;
}

Eigen::MatrixXd marker_load_motions(SimulationParts& parts) {
  NewtonSolver& solver = parts.workspace.newton;
  const NewtonState state = parts.unknowns_at_step();
  const auto columns = 3 * static_cast<Eigen::Index>(parts.markers.size());
  NewtonDrive drive{Eigen::MatrixXd::Zero(state.positions_m.size(), columns),
                    Eigen::MatrixXd::Zero(solver.tables().constraint_count(), columns),
                    Eigen::MatrixXd::Zero(solver.tables().constraint_count(), columns),
                    {}};
  drive.free_forces.setZero(6 * solver.contact().free().count(), columns);
  Eigen::Matrix3Xd forces_n(3, state.positions_m.cols());
  for (Eigen::Index column = 0; column < columns; ++column) {
    forces_n.setZero();
    parts.markers[static_cast<std::size_t>(column / 3)].add_force(
        state.positions_m, Eigen::Vector3d::Unit(static_cast<int>(column % 3)), forces_n);
    drive.forces_n.col(column) = -parts.body.fixed().array().select(0.0, forces_n.array()).matrix().reshaped();
  }
  const NewtonResponse response = solver.respond(state, drive);
  if (!response.stable) throw std::runtime_error("no compliance: the present state is not a stable equilibrium");
  return response.motions_m;
}

}  // namespace soft_robot_lab
