// SPDX-License-Identifier: BSD-3-Clause
#include "scene_motion.h"

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
  fast_.emplace(reduction_->choice.model);
  fast_markers_.emplace(*reduction_->choice.model);
}

void SceneMotion::reset() {
  simulation_.reset();
  warnings_.clear();
  if (reduction_) fast_.emplace(reduction_->choice.model);  // without what the last one has factorised
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
  return finish(done ? *done : simulation_.step());
}

SolveReport SceneMotion::solve_equilibrium() {
  const auto done = by_reduced(&ReducedSimulation::solve_equilibrium, "the reduced model found no equilibrium");
  return finish(done ? *done : simulation_.solve_equilibrium());
}

std::optional<SolveReport> SceneMotion::by_reduced(ReducedReport (ReducedSimulation::*move)(),
                                                   const std::string& failure) {
  if (!fast_) return std::nullopt;
  const Clock::time_point start = Clock::now();
  const ReducedReport done = ((*fast_).*move)();
  if (done.converged) return report_of(done, start);
  leave(failure);
  return std::nullopt;
}

SolveReport SceneMotion::finish(SolveReport report) {
  for (const SolveWarning& warning : warnings_) add_warning(warning, report.warnings);
  warnings_.clear();
  return report;
}

void SceneMotion::leave(const std::string& why) {
  show();
  SolveWarning warning;
  warning.kind = "outside_training";
  warning.text = why + "; from " + std::to_string(time_s()) + " s on newton moves the robot";
  warnings_.push_back(warning);
  fast_.reset();
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
  const ReducedState& from = fast_->state();
  const ReducedBasis& basis = fast_->model().basis;
  SimulationState to = simulation_.state();
  const Eigen::VectorXd velocities = basis.modes * from.velocity;
  to.time_s = from.time_s;
  to.positions_m = fast_->positions_m();
  to.velocities_m_s = Eigen::Map<const Eigen::Matrix3Xd>(velocities.data(), 3, velocities.size() / 3);
  to.element_multipliers_pa = basis.pressures * from.at.pressures;
  to.constraint_multipliers = from.at.tensions_n;
  to.drives = from.drives;
  to.rest_residual.reset();
  simulation_.set_state(to);
}

}  // namespace soft_robot_lab
