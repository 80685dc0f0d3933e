// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_simulation.h"

#include <algorithm>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "snapshots.h"
#include "mechanics/elements/elements.h"
#include "mechanics/simulation/workspace.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {
namespace {

constexpr double kShortestPart = 1.0 / 64.0;  // of a time step
constexpr int kNearIterations = 15;           // of Newton; with more it may have found another branch than that nearby
constexpr int kKnownRests = 3;                // that an equilibrium may start from
constexpr int kContinuationSteps = 200;
constexpr double kFirstArtificialStep_s = 0.02, kLongestArtificialStep_s = 100.0, kShortestArtificialStep_s = 1e-5;

void count(const ReducedEnd& end, ReducedReport& report) {
  report.iterations += end.iterations;
  report.factorisations += end.factorisations;
  ++report.steps;
}

}  // namespace

ReducedSimulation::ReducedSimulation(std::shared_ptr<const ReducedModel> model)
    : model_(std::move(model)), newton_(*model_) {
  reset();
}

void ReducedSimulation::reset() {
  state_ = {};
  state_.at = {Eigen::VectorXd::Zero(model_->energy.modes()), Eigen::VectorXd::Zero(model_->energy.pressures()),
               Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model_->constraints.count())),
               Eigen::VectorXd::Zero(model_->skin.places())};
  state_.velocity = state_.previous_velocity = Eigen::VectorXd::Zero(model_->energy.modes());
  for (const auto& actuator : model_->full->actuators()) state_.drives.push_back(actuator->rest_state());
}

void ReducedSimulation::set_tolerance_m(double time_step_m, double equilibrium_m) {
  if (!(time_step_m > 0.0) || !(equilibrium_m > 0.0))
    throw std::invalid_argument("a tolerance of a reduced simulation must be > 0 m");
  step_tolerance_m_ = time_step_m;
  rest_tolerance_m_ = equilibrium_m;
}

void ReducedSimulation::set_command(const std::string& actuator, double command) {
  const auto i = static_cast<std::size_t>(model_->full->actuator_index(actuator));
  const double min = model_->box.min[i], max = model_->box.max[i];
  if (!(command >= min && command <= max)) {
    std::ostringstream message;
    message << actuator << ": command " << command << " is outside [" << min << ", " << max
            << "], for which the reduced model was trained; train it with a larger range, or use method newton";
    throw std::invalid_argument(message.str());
  }
  model_->full->actuators()[i]->set_command(command, state_.drives[i]);
}

int ReducedSimulation::inverted_elements() const {
  const Elements elements(model_->full->tables().newton->elements);
  const Eigen::Matrix3Xd shape_m = positions_m();
  Eigen::Matrix3Xd forces_n = Eigen::Matrix3Xd::Zero(3, shape_m.cols());
  return elements.add_gradient(shape_m, Eigen::VectorXd::Zero(elements.multiplier_count()), forces_n).inverted;
}

ReducedReport ReducedSimulation::run(const std::function<void(ReducedReport&)>& solve) {
  const Interrupt::Solve running(interrupt_, model_->full->options().time_limit_s);
  newton_.heed(&interrupt_);
  const ReducedState before = state_;
  ReducedReport report;
  try {
    interrupt_.check();
    solve(report);
  } catch (const SolveInterrupted& interrupted) {
    report.converged = false;
    report.interrupted = interrupted.why;
  }
  if (!report.converged) state_ = before;
  return report;
}

ReducedReport ReducedSimulation::step() {
  return run([this](ReducedReport& report) {
    const double h = model_->full->options().time_step_s;
    report.converged = advance(h, advance_drives(h), 0.0, 1.0, report);
  });
}

ReducedSimulation::CommandPath ReducedSimulation::advance_drives(double h) {
  CommandPath path;
  for (std::size_t i = 0; i < state_.drives.size(); ++i) {
    path.from.push_back(state_.drives[i].actuated_command);
    model_->full->actuators()[i]->advance(h, state_.drives[i]);
    path.to.push_back(state_.drives[i].actuated_command);
  }
  return path;
}

void ReducedSimulation::place_drives(const CommandPath& path, double share) {
  for (std::size_t i = 0; i < state_.drives.size(); ++i)
    model_->full->actuators()[i]->place(path.from[i] + share * (path.to[i] - path.from[i]), state_.drives[i]);
}

void ReducedSimulation::begin_step(double h) {
  if (!model_->constraints.begin_steps()) return;
  const Eigen::VectorXd velocities = model_->basis.modes * state_.velocity;
  const Eigen::Matrix3Xd shape_m = positions_m(), velocities_m_s = velocities.reshaped(3, velocities.size() / 3);
  const double* multiplier = state_.at.multipliers.data();
  for (std::size_t i = 0; i < state_.drives.size(); ++i) {
    const Actuator& actuator = *model_->full->actuators()[i];
    const std::size_t count = actuator.constraints().size();
    actuator.begin_step({h, shape_m, velocities_m_s, {multiplier, multiplier + count}}, state_.drives[i]);
    multiplier += count;
  }
}

void ReducedSimulation::keep_slips() {
  const double* slip = state_.at.slips_m.data();
  for (std::size_t i = 0; i < state_.drives.size(); ++i) {
    const Actuator& actuator = *model_->full->actuators()[i];
    const std::size_t count = actuator.friction_contacts().size();
    actuator.end_step({slip, slip + count}, state_.drives[i]);
    slip += count;
  }
  state_.at.slips_m.setZero();
}

// A velocity of implicit Euler is that of the middle of its step.
Eigen::VectorXd ReducedSimulation::predicted(double h) const {
  const double before_s = state_.previous_step_s;
  const Eigen::VectorXd even = state_.at.q + h * state_.velocity;
  if (before_s == 0.0 || h > constants::kLargestGrowth * before_s) return even;
  return even + 0.5 * h * (h + before_s) / before_s * (state_.velocity - state_.previous_velocity);
}

bool ReducedSimulation::advance(double h, const CommandPath& path, double from, double to, ReducedReport& report) {
  const ReducedState before = state_;
  const double part_s = (to - from) * h;
  place_drives(path, to);
  begin_step(part_s);
  state_.at.q = predicted(part_s);
  const double slowed = 1.0 + model_->full->body().viscosity().rayleigh_mass_per_s * part_s;  // as newton's steps
  const ReducedTask task{slowed / (part_s * part_s), before.at.q + part_s / slowed * before.velocity,
                         step_tolerance_m_};
  const ReducedEnd end = newton_.solve(task, state_.drives, state_.at);
  count(end, report);
  if (end.converged) {
    state_.previous_velocity = before.velocity;
    state_.previous_step_s = part_s;
    state_.velocity = (state_.at.q - before.at.q) / part_s;
    state_.time_s += part_s;
    keep_slips();
    return true;
  }
  state_ = before;
  const double middle = 0.5 * (from + to);
  return to - from > kShortestPart && advance(h, path, from, middle, report) && advance(h, path, middle, to, report);
}

bool ReducedSimulation::relax(int most_iterations, ReducedReport& report) {
  ReducedUnknowns trial = state_.at;
  const ReducedEnd end = newton_.solve({0.0, trial.q, rest_tolerance_m_}, state_.drives, trial);
  count(end, report);
  if (!end.converged || end.iterations > most_iterations || !newton_.stable(state_.drives, trial)) return false;
  state_.at = trial;
  keep_slips();
  return true;
}

bool ReducedSimulation::at_rest_commands() const {
  for (std::size_t i = 0; i < state_.drives.size(); ++i)
    if (state_.drives[i].actuated_command != model_->full->actuators()[i]->limits().rest) return false;
  return true;
}

// A body that buckles may do so to either side. The full model has gone to one of them from its rest shape.
bool ReducedSimulation::relax_beside_known_rests(ReducedReport& report) {
  const KnownRests& rests = model_->rests;
  Eigen::VectorXd far = Eigen::VectorXd::Zero(rests.commands.cols());
  for (std::size_t i = 0; i < state_.drives.size() && far.size() > 0; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double range = model_->box.max[i] - model_->box.min[i];
    far += ((rests.commands.row(row).array() - state_.drives[i].command) / range).square().matrix().transpose();
  }
  const ReducedUnknowns before = state_.at;
  for (int tries = 0; tries < kKnownRests && tries < far.size(); ++tries) {
    Eigen::Index nearest = 0;
    far.minCoeff(&nearest);
    far[nearest] = std::numeric_limits<double>::infinity();
    state_.at = {rests.q.col(nearest), rests.pressures.col(nearest), rests.multipliers.col(nearest),
                 Eigen::VectorXd::Zero(model_->skin.places())};
    if (relax(kNearIterations, report)) return true;
  }
  state_.at = before;
  return false;
}

SimulationState full_state(const ReducedModel& model, const ReducedState& state, SimulationState base) {
  const Eigen::VectorXd velocities = model.basis.modes * state.velocity;
  base.time_s = state.time_s;
  base.positions_m = model.positions_m(state.at.q);
  base.velocities_m_s = Eigen::Map<const Eigen::Matrix3Xd>(velocities.data(), 3, velocities.size() / 3);
  base.element_multipliers_pa = model.basis.pressures * state.at.pressures;
  base.constraint_multipliers = state.at.multipliers;
  base.drives = state.drives;
  if (model.skin.places() > 0) {
    base.contact = model.full->tables().newton->contact.untouched(base.positions_m, state.time_s);
    model.skin.add_pressures(state.at.pushes_n, base.contact.pressures_pa);
  }
  base.rest_residual.reset();
  return base;
}

ReducedState nearest_state(const ReducedModel& model, const SimulationState& full) {
  ReducedState state;
  state.time_s = full.time_s;
  state.at = projected(model, snapshot_of(full, model.full->body(), 0.0));
  state.velocity = model.basis.modes.transpose() *
                   masses_of_axes_kg(model.full->body()).cwiseProduct(full.velocities_m_s.reshaped());
  state.previous_velocity = state.velocity;
  state.drives = full.drives;
  return state;
}

ReducedSimulation::CommandPath ReducedSimulation::come_to_rest() {
  CommandPath path = advance_drives(std::numeric_limits<double>::infinity());
  state_.velocity.setZero();
  state_.previous_velocity.setZero();
  state_.previous_step_s = 0.0;
  begin_step(std::numeric_limits<double>::infinity());
  return path;
}

ReducedReport ReducedSimulation::solve_nearby() {
  return run([this](ReducedReport& report) {
    come_to_rest();
    report.converged = relax(kNearIterations, report);
  });
}

ReducedReport ReducedSimulation::solve_equilibrium() {
  return run([this](ReducedReport& report) { seek_equilibrium(report); });
}

// What slips hangs on the way: commands come in stages as long as Newton's method bears. Another state's cable would
// hold other stretches, and a search swings to and fro.
bool ReducedSimulation::relax_along_commands(const CommandPath& path, ReducedReport& report) {
  for (double done = 0.0, stage = 1.0; done < 1.0;) {
    const double share = std::min(1.0, done + stage);
    place_drives(path, share);
    const bool rests = relax(kNearIterations, report);
    if (rests) done = share;
    stage *= rests ? 2.0 : 0.5;
    if (stage < kShortestPart) return false;
  }
  return true;
}

void ReducedSimulation::seek_equilibrium(ReducedReport& report) {
  const bool from_rest = at_rest_commands();
  const CommandPath path = come_to_rest();
  if (model_->constraints.friction_contact_count() > 0) {
    report.converged = relax_along_commands(path, report);
    return;
  }
  report.converged = relax(kNearIterations, report) || (from_rest && relax_beside_known_rests(report));
  const bool searches = !from_rest || model_->rests.commands.cols() == 0;
  // Down the energy with a proximal term that fades (pseudo-transient continuation, Kelley & Keyes 1998), but not so
  // fast that a step has more than one end: it would stay on a saddle, where a slower one leaves it.
  double h = kFirstArtificialStep_s;
  for (int i = 0; searches && i < kContinuationSteps && !report.converged && h >= kShortestArtificialStep_s; ++i) {
    ReducedUnknowns trial = state_.at;
    const double inertia_per_s2 = 1.0 / (h * h);
    const ReducedEnd end = newton_.solve({inertia_per_s2, trial.q, 1e-6}, state_.drives, trial);
    count(end, report);
    const bool down = end.converged && newton_.stable(state_.drives, trial, inertia_per_s2);
    if (down) state_.at = trial;
    h = down ? std::min(2.0 * h, kLongestArtificialStep_s) : 0.25 * h;
    if (down && h > 1.0) report.converged = relax(std::numeric_limits<int>::max(), report);
  }
}

}  // namespace soft_robot_lab
