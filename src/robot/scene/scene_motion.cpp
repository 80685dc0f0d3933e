// SPDX-License-Identifier: BSD-3-Clause
#include "scene_motion.h"

#include <algorithm>
#include <chrono>
#include <sstream>

#include "reduction.h"

namespace soft_robot_lab {
namespace {

using Clock = std::chrono::steady_clock;

SolveReport report_of(const ReducedReport& reduced, Clock::time_point start) {
  SolveReport report;
  report.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  report.converged = reduced.converged;
  report.interrupted = !reduced.interrupted.empty();
  report.message = reduced.interrupted;
  report.iterations = reduced.iterations;
  report.factorisations = reduced.factorisations;
  report.steps = reduced.steps;
  enter(SolveStage::reduced, reduced.iterations, report.path);
  return report;
}

}  // namespace

SceneMotion::SceneMotion(Simulation& simulation, std::shared_ptr<const SceneReduction> reduction)
    : simulation_(simulation), reduction_(std::move(reduction)) {
  if (!reduction_) return;
  judge_by_reduction();
  reset();
}

void SceneMotion::judge_by_reduction() {
  fast_markers_.emplace(*reduction_->choice.model);
  audit_.emplace(*reduction_->choice.model, simulation_.model());
}

void SceneMotion::reset() {
  simulation_.reset();
  warnings_.clear();
  corrected_.reset();
  audited_s_ = 0.0;
  audits_ = {};
  if (!reduction_) return;
  fast_.emplace(reduction_->choice.model);  // without what the last one has factorised
  audits_.limit_m = reduction_->choice.trusted_m();
}

SceneMotion::Place SceneMotion::place() {
  show();
  return {simulation_.state(), fast_ ? std::optional(fast_->state()) : std::nullopt};
}

void SceneMotion::go_to(const Place& place) {
  reset();
  simulation_.set_state(place.full);
  audited_s_ = place.full.time_s;
  if (place.reduced)
    fast_->set_state(*place.reduced);
  else
    fast_.reset();
}

void SceneMotion::go_on_from(const SimulationState& state) {
  reset();
  SimulationState to = simulation_.state();
  to.time_s = state.time_s;
  to.positions_m = state.positions_m;
  to.velocities_m_s = state.velocities_m_s;
  to.element_multipliers_pa = state.element_multipliers_pa;
  to.constraint_multipliers = state.constraint_multipliers;
  to.contact = state.contact;
  to.free_velocities = state.free_velocities;
  to.element_forces_n.resize(0);  // those of the shape
  to.branch_stress_pa = state.branch_stress_pa;
  to.drives = state.drives;
  go_to({std::move(to), std::nullopt});
  to_reduced();
}

void SceneMotion::to_newton(const std::string& why) {
  if (fast_) leave(why);
}

bool SceneMotion::to_reduced(std::shared_ptr<const SceneReduction> trained) {
  reduction_ = std::move(trained);
  judge_by_reduction();
  audits_.limit_m = reduction_->choice.trusted_m();
  return to_reduced();
}

// Where the robot rests an audit says how far away the reduced model will: of its own rest state, as a state of the
// full model that is projected would pass. What an audit has refused is taken only where this one passes.
bool SceneMotion::trusted_to_begin(const ReducedState& state) {
  constexpr double still_m_s = 1e-3;
  if (simulation_.state().velocities_m_s.colwise().norm().maxCoeff() > still_m_s) return !audits_.failed;
  ReducedSimulation there(reduction_->choice.model);
  there.set_state(state);
  if (!there.solve_nearby().converged) return !audits_.failed;
  const AuditResult found = audit_->at_rest(there.state());
  if (!found.found || found.estimate_m > audits_.limit_m) return !audits_.failed;
  ++audits_.states;
  audits_.largest_estimate_m = std::max(audits_.largest_estimate_m, found.estimate_m);
  return true;
}

bool SceneMotion::to_reduced() {
  if (!left()) return reduced();
  const ReducedModel& model = *reduction_->choice.model;
  const SimulationState& from = simulation_.state();
  for (std::size_t i = 0; i < from.drives.size(); ++i)
    for (const double command : {from.drives[i].command, from.drives[i].actuated_command})
      if (command < model.box.min[i] || command > model.box.max[i]) return false;
  const ReducedState nearest = nearest_state(model, from);
  const Eigen::Matrix3Xd jump_m = fast_markers_->places_m(nearest.at.q) - markers_m();
  if (jump_m.cols() > 0 && jump_m.colwise().norm().maxCoeff() > audits_.limit_m) return false;
  if (!trusted_to_begin(nearest)) return false;
  fast_.emplace(reduction_->choice.model);
  fast_->set_state(nearest);
  audited_s_ = nearest.time_s;
  audits_.failed = false;
  corrected_.reset();
  return true;
}

void SceneMotion::set_command(const std::string& actuator, double command) {
  if (fast_) {
    const auto i = static_cast<std::size_t>(simulation_.actuator_index(actuator));
    const CommandBox& box = fast_->model().box;
    if (command >= box.min[i] && command <= box.max[i]) return fast_->set_command(actuator, command);
    std::ostringstream why;
    why << "command " << command << " of " << actuator << " is outside [" << box.min[i] << ", " << box.max[i]
        << "], for which the reduced model was trained";
    leave(why.str());
  }
  simulation_.set_command(actuator, command);
}

SolveReport SceneMotion::step() {
  const auto done = by_reduced(&ReducedSimulation::step, "a step of the reduced model did not converge");
  if (done && done->converged && fast_->state().time_s - audited_s_ >= (1.0 - 1e-9) * reduction_->request.audit_every_s)
    if (const std::string why = audit(false); !why.empty()) leave(why);
  return finish(done ? *done : simulation_.step());
}

// Where `newton` answers it starts where the reduced model did: a way that ends elsewhere may lead to another side.
SolveReport SceneMotion::solve_equilibrium() {
  std::optional<ReducedState> before;
  if (fast_) before = fast_->state();
  const auto done = by_reduced(&ReducedSimulation::solve_equilibrium, "the reduced model found no equilibrium");
  const std::string why = done && done->converged ? audit(true) : "";
  if (!why.empty()) {
    fast_->set_state(*before);
    leave(why);
  }
  return finish(done && why.empty() ? *done : simulation_.solve_equilibrium());
}

std::optional<SolveReport> SceneMotion::by_reduced(ReducedReport (ReducedSimulation::*move)(),
                                                   const std::string& failure) {
  if (!fast_) return std::nullopt;
  corrected_.reset();
  const Clock::time_point start = Clock::now();
  fast_->set_interrupt(simulation_.interrupt());
  const ReducedReport done = ((*fast_).*move)();
  if (done.converged || !done.interrupted.empty()) return report_of(done, start);
  leave(failure);
  return std::nullopt;
}

std::string SceneMotion::audit(bool at_rest) {
  AuditResult found = at_rest ? audit_->at_rest(fast_->state()) : audit_->in_motion(fast_->state());
  ++audits_.states;
  audits_.largest_estimate_m = std::max(audits_.largest_estimate_m, found.estimate_m);
  const double before_s = audited_s_;
  audited_s_ = fast_->state().time_s;
  if (found.found && found.estimate_m <= audits_.limit_m) {
    if (at_rest) corrected_ = std::move(found);
    return "";
  }
  audits_.failed = true;
  std::ostringstream why;
  why << "an audit of the reduced model ";
  if (found.found) {
    why << "estimates an error of " << found.estimate_m << " m, beyond " << audits_.limit_m << " m";
  } else {
    why << "found no solution nearby";
  }
  if (!at_rest) why << "; the one before was at " << before_s << " s";
  return why.str();
}

void SceneMotion::audit_end(SolveReport& report) {
  if (!fast_ || fast_->state().time_s == audited_s_) return;
  if (const std::string why = audit(false); !why.empty()) warn(why + ", at the end of the run");
  report = finish(std::move(report));
}

SolveReport SceneMotion::finish(SolveReport report) {
  for (const SolveWarning& warning : warnings_) add_warning(warning, report.warnings);
  warnings_.clear();
  return report;
}

void SceneMotion::leave(const std::string& why) {
  show();
  warn(why + "; from " + std::to_string(time_s()) + " s on newton moves the robot");
  fast_.reset();
}

void SceneMotion::warn(const std::string& text) {
  SolveWarning warning;
  warning.kind = "outside_training";
  warning.text = text;
  warnings_.push_back(warning);
}

double SceneMotion::time_s() const { return fast_ ? fast_->state().time_s : simulation_.state().time_s; }

const DriveStates& SceneMotion::drives() const { return fast_ ? fast_->state().drives : simulation_.state().drives; }

Eigen::Matrix3Xd SceneMotion::markers_m() {
  if (fast_) return fast_markers_->places_m(fast_->state().at.q);
  Eigen::Matrix3Xd markers_m(3, static_cast<Eigen::Index>(simulation_.markers().size()));
  for (Eigen::Index i = 0; i < markers_m.cols(); ++i)
    markers_m.col(i) = simulation_.marker_position(static_cast<int>(i));
  return markers_m;
}

void SceneMotion::show() {
  if (!fast_) return;
  SimulationState to = full_state(fast_->model(), fast_->state(), simulation_.state());
  if (corrected_) {
    to.positions_m = corrected_->positions_m;
    to.element_multipliers_pa = corrected_->element_multipliers_pa;
    to.constraint_multipliers = corrected_->constraint_multipliers;
  }
  simulation_.set_state(to);
}

void add_report(const SolveReport& part, SolveReport& total) {
  total.converged = total.converged && part.converged;
  total.interrupted = total.interrupted || part.interrupted;
  total.iterations += part.iterations;
  total.factorisations += part.factorisations;
  total.steps += part.steps;
  total.rejected_steps += part.rejected_steps;
  total.residual = std::max(total.residual, part.residual);
  total.wall_s += part.wall_s;
  total.inverted_elements = part.inverted_elements;
  for (const SolvePathStage& stage : part.path) enter(stage.stage, stage.count, total.path);
  for (const SolveWarning& warning : part.warnings) add_warning(warning, total.warnings);
  if (!part.message.empty()) total.message = part.message;
}

void require_commands(const Model& model, const std::vector<std::pair<std::string, double>>& commands) {
  for (const auto& [name, command] : commands)
    model.actuators()[static_cast<std::size_t>(model.actuator_index(name))]->require_in_limits(command);
}

}  // namespace soft_robot_lab
