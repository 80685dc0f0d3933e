// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/simulation.h"

#include <chrono>
#include <stdexcept>

#include "actuator_warnings.h"
#include "equilibrium.h"
#include "limit_hint.h"
#include "mechanics/contact/coarse_contact.h"
#include "mechanics/contact/passed_obstacles.h"
#include "parameter_response.h"
#include "rest.h"
#include "simulation_parts.h"
#include "state_check.h"
#include "substepping.h"
#include "time_stepping.h"

namespace soft_robot_lab {
namespace {

void warn_of_actuators(const Simulation& simulation, SolveReport& report) {
  for (std::size_t i = 0; i < simulation.actuators().size(); ++i)
    for (const SolveWarning& warning :
         actuator_warnings(simulation.actuator_state(static_cast<int>(i)), simulation.body()))
      add_warning(warning, report.warnings);
  refuse_impossible(report.warnings, report);
}

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Whose command each column of NewtonSolver::sensitivities follows.
std::vector<std::size_t> actuator_of_columns(const SimulationParts& parts) {
  std::vector<std::size_t> all;
  for (std::size_t a = 0; a < parts.actuators.size(); ++a)
    all.insert(all.end(), parts.actuators[a]->constraints().size(), a);
  for (std::size_t a = 0; a < parts.actuators.size(); ++a)
    all.insert(all.end(), parts.actuators[a]->energy_terms().size(), a);
  return all;
}

// d tension / d command of the actuators, from d multiplier / d command of the constraints: a tension is linear in its
// actuator's multipliers, and every constraint follows its actuator's command.
Eigen::MatrixXd tension_changes(const SimulationParts& parts, const Eigen::MatrixXd& multipliers) {
  const Eigen::Index count = static_cast<Eigen::Index>(parts.actuators.size());
  Eigen::MatrixXd changes = Eigen::MatrixXd::Zero(count, count);
  std::vector<Eigen::Index> first(parts.actuators.size() + 1, 0);
  for (std::size_t i = 0; i < parts.actuators.size(); ++i)
    first[i + 1] = first[i] + static_cast<Eigen::Index>(parts.actuators[i]->constraints().size());
  const std::vector<std::size_t> followed = actuator_of_columns(parts);
  for (std::size_t i = 0; i < parts.actuators.size(); ++i) {
    const auto tension_n = [&](const std::vector<double>& of) {
      return parts.actuators[i]->observe(parts.state.positions_m, of, parts.state.drives[i]).tension_n;
    };
    std::vector<double> here = parts.multipliers_of(i);
    if (!tension_n(here)) continue;
    for (std::size_t a = 0; a < parts.actuators.size(); ++a) {
      std::vector<double> there = here;
      for (Eigen::Index column = 0; column < multipliers.cols(); ++column)
        for (std::size_t k = 0; k < there.size() && followed[static_cast<std::size_t>(column)] == a; ++k)
          there[k] += multipliers(first[i] + static_cast<Eigen::Index>(k), column);
      changes(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(a)) = *tension_n(there) - *tension_n(here);
    }
  }
  return changes;
}

}  // namespace

Simulation::Simulation(Body body, std::vector<std::unique_ptr<Actuator>> actuators, std::vector<Marker> markers,
                       const SolverOptions& options)
    : Simulation(std::make_shared<const Model>(std::move(body), std::move(actuators), std::move(markers), options)) {}

Simulation::Simulation(std::shared_ptr<const Model> model)
    : parts_(std::make_unique<SimulationParts>(std::move(model))) {
  reset();
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;

void Simulation::set_command(const std::string& actuator, double command) {
  const int index = actuator_index(actuator);
  try {
    parts_->actuators[index]->set_command(command, parts_->state.drives[index]);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(error.what() +
                                limit_hint(*this, index, command < parts_->actuators[index]->limits().min));
  }
}

void Simulation::set_interrupt(std::function<bool()> ends) { parts_->workspace.interrupt.ends = std::move(ends); }
const std::function<bool()>& Simulation::interrupt() const { return parts_->workspace.interrupt.ends; }

SolveReport Simulation::timed(const std::function<void(SolveReport&)>& solve) {
  const Stopwatch clock;
  SolveReport report;
  if (parts_->solve_or_go_back(solve, report)) {
    take_along_linearisation();
    warn_of_actuators(*this, report);
    for (const SolveWarning& warning :
         coarse_contacts(body(), parts_->workspace.newton.contact(), parts_->state.positions_m, parts_->state.contact))
      add_warning(warning, report.warnings);
  }
  report.wall_s = clock.seconds();
  return report;
}

SolveReport Simulation::step() {
  const ContactTerm& contact = parts_->workspace.newton.contact();
  const bool may_pass = has_small_obstacles(body(), contact);
  const Eigen::Matrix3Xd from_m = may_pass ? parts_->state.positions_m : Eigen::Matrix3Xd();
  const ContactState from = may_pass ? parts_->state.contact : ContactState();
  return timed([&](SolveReport& report) {
    if (parts_->workspace.xpbd) {
      step_in_substeps(*parts_, report);
    } else {
      step_in_time(*parts_, parts_->options.time_step_s, report);
    }
    if (!may_pass) return;
    const std::vector<SolveWarning> passed = passed_obstacles(
        body(), contact, {from_m, from}, {parts_->state.positions_m, parts_->state.contact}, PassedSizes::small);
    for (const SolveWarning& warning : passed) add_warning(warning, report.warnings);
  });
}

SolveReport Simulation::solve_equilibrium(const EquilibriumOptions& options) {
  for (const auto& actuator : parts_->actuators)
    if (const std::string why = actuator->why_no_equilibrium(); !why.empty())
      throw std::invalid_argument("actuator '" + actuator->name() + "': " + why);
  SolveReport report = timed([&](SolveReport& solved) {
    parts_->forget_motion();
    parts_->begin_step();
    if (parts_->workspace.xpbd) {
      settle_in_substeps(*parts_, options, solved);
    } else {
      find_equilibrium(*parts_, options, solved);
    }
  });
  if (report.converged && options.warns_of_left_out)
    for (const SolveWarning& warning : unmodelled_contact()) add_warning(warning, report.warnings);
  return report;
}

Eigen::MatrixXd Simulation::marker_sensitivities(Eigen::MatrixXd* tensions_n) {
  SimulationParts& p = *parts_;
  const bool driven = p.workspace.newton.tables().constraint_count() + p.workspace.newton.tables().term_count() > 0;
  if (driven) require_rest(p);
  Eigen::MatrixXd multipliers;
  const Eigen::MatrixXd motions = p.workspace.newton.sensitivities(p.unknowns_at_step(), &multipliers);
  take_along_linearisation();
  if (motions.rows() == 0 && driven)
    throw std::runtime_error("no sensitivity: the present state is not a stable equilibrium");
  if (tensions_n) *tensions_n = tension_changes(p, multipliers);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(p.markers.size()),
                                                 static_cast<Eigen::Index>(p.actuators.size()));
  const std::vector<std::size_t> followed = actuator_of_columns(p);
  for (std::size_t column = 0; column < followed.size(); ++column) {
    const Eigen::Map<const Eigen::Matrix3Xd> motion(motions.col(static_cast<Eigen::Index>(column)).data(), 3,
                                                    p.state.positions_m.cols());
    for (std::size_t m = 0; m < p.markers.size(); ++m)
      result.block<3, 1>(3 * static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(followed[column])) +=
          p.markers[m].velocity(p.state.positions_m, motion);
  }
  return result;
}

Eigen::MatrixXd Simulation::parameter_sensitivities(const std::vector<ModelParameter>& parameters,
                                                    Eigen::MatrixXd& slipped_m) {
  SimulationParts& p = *parts_;
  const Eigen::MatrixXd motions = parameter_motions(p, parameters, slipped_m);
  take_along_linearisation();
  Eigen::MatrixXd result(3 * static_cast<Eigen::Index>(p.markers.size()), motions.cols());
  for (Eigen::Index column = 0; column < motions.cols(); ++column) {
    const Eigen::Map<const Eigen::Matrix3Xd> motion(motions.col(column).data(), 3, p.state.positions_m.cols());
    for (std::size_t m = 0; m < p.markers.size(); ++m)
      result.block<3, 1>(3 * static_cast<Eigen::Index>(m), column) = p.markers[m].velocity(p.state.positions_m, motion);
  }
  return result;
}

Eigen::MatrixXd Simulation::marker_compliances() {
  SimulationParts& p = *parts_;
  Eigen::MatrixXd result = marker_load_motions(p);
  take_along_linearisation();
  return result;
}

void Simulation::pull(const std::vector<PointLoad>& loads) {
  if (parts_->energy) throw std::invalid_argument("pull: the energy ledger does not know its work");
  Eigen::Matrix3Xd forces_n = Eigen::Matrix3Xd::Zero(3, parts_->state.positions_m.cols());
  for (const PointLoad& load : loads) {
    if (!load.force_n.allFinite()) throw std::invalid_argument("pull: the force is not finite");
    for (std::size_t k = 0; k < load.at.nodes.size(); ++k) {
      if (load.at.nodes[k] < 0 || load.at.nodes[k] >= forces_n.cols())
        throw std::invalid_argument("pull: node " + std::to_string(load.at.nodes[k]) + " is out of range [0, " +
                                    std::to_string(forces_n.cols()) + ")");
      forces_n.col(load.at.nodes[k]) += load.at.weights[k] * load.force_n;
    }
  }
  parts_->workspace.newton.loads().pull(forces_n);
  if (parts_->workspace.xpbd) parts_->workspace.xpbd->take_loads(parts_->workspace.newton.energies().loads.all_n());
  parts_->state.rest_residual.reset();
}

void Simulation::reset() { parts_->reset(); }
const SimulationState& Simulation::state() const { return parts_->state; }

// The state knows where the solver's factor was made, so that a copy of it goes on to the last bit.
void Simulation::take_along_linearisation() {
  if (!parts_->workspace.xpbd) parts_->state.linearisation = parts_->workspace.newton.system().linearisation();
}

void Simulation::set_state(const SimulationState& state) {
  check_state(state, parts_->state);
  for (std::size_t i = 0; i < parts_->actuators.size(); ++i)
    parts_->actuators[i]->require_in_limits(state.drives[i].command);
  parts_->set_state(state);
  // A state may have been changed since it slept.
  std::optional<double>& residual = parts_->state.rest_residual;
  if (residual && (!state.velocities_m_s.isZero(0.0) || residual_at_rest(*parts_) != *residual)) residual.reset();
  if (!parts_->workspace.xpbd) parts_->workspace.newton.system().restore(state.linearisation);
}

const std::shared_ptr<const Model>& Simulation::model() const { return parts_->model; }
const Body& Simulation::body() const { return parts_->body; }
const SolverOptions& Simulation::options() const { return parts_->options; }
const std::vector<Marker>& Simulation::markers() const { return parts_->markers; }
const std::vector<std::unique_ptr<const Actuator>>& Simulation::actuators() const { return parts_->actuators; }

int Simulation::actuator_index(const std::string& name) const { return parts_->model->actuator_index(name); }
int Simulation::marker_index(const std::string& name) const { return parts_->model->marker_index(name); }

Eigen::Matrix3Xd Simulation::reaction_forces_n() const {
  Eigen::Matrix3Xd forces_n = parts_->workspace.newton.reaction_forces_n(parts_->unknowns());
  if (parts_->state.hold_inertia_n.cols() > 0) forces_n += parts_->state.hold_inertia_n;
  return forces_n;
}

void Simulation::keep_energy_ledger() {
  if (parts_->workspace.xpbd) throw std::invalid_argument("the energy ledger is not for solver.method xpbd");
  parts_->energy.emplace(*parts_);
}

const EnergyLedger* Simulation::energy_ledger() const { return parts_->energy ? &parts_->energy->ledger() : nullptr; }

Eigen::Vector3d Simulation::marker_position(int marker) const {
  return parts_->markers.at(marker).position(parts_->state.positions_m);
}

std::vector<ContactReading> Simulation::contacts() const {
  return parts_->workspace.newton.contact().readings(parts_->state.positions_m, parts_->state.contact);
}

std::vector<SolveWarning> Simulation::unmodelled_contact() const {
  std::vector<std::vector<Eigen::Vector3d>> paths_m;
  for (std::size_t i = 0; i < actuators().size(); ++i) paths_m.push_back(parts_->reading_of(i).path_m);
  const SolverTables& tables = parts_->model->tables();
  TetMesh present = body().mesh();
  present.nodes_m = parts_->state.positions_m;
  std::vector<SolveWarning> warnings = tables.air_spans.in_silicone(body().mesh(), present, paths_m);
  if (const auto skin = tables.skin_overlap.deepest(body(), present)) warnings.push_back(*skin);
  if (const auto skin = tables.skin_overlap.deepest_in_spite_of_contact(body(), present)) warnings.push_back(*skin);
  return warnings;
}

std::vector<Eigen::Isometry3d> Simulation::obstacle_poses() const {
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < body().obstacles().size(); ++i)
    poses.push_back(parts_->workspace.newton.contact().pose_of(static_cast<int>(i), parts_->state.contact));
  return poses;
}

ActuatorReading Simulation::actuator_state(int actuator) const {
  return parts_->reading_of(static_cast<std::size_t>(actuator));
}

}  // namespace soft_robot_lab
