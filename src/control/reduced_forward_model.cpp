// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_forward_model.h"

#include <algorithm>

#include "mechanics/reduced/reduced_sensitivities.h"
#include "mechanics/reduced/snapshots.h"
#include "soft_robot_lab/control/forward_model.h"

namespace soft_robot_lab {
namespace {

constexpr int kStages = 4;                     // of a trial that is too far for one
constexpr std::size_t kReducedRemembered = 8;  // equilibria

void require_rest(const ReducedReport& report) {
  if (!report.interrupted.empty()) throw ForwardModelInterrupted();
  if (!report.converged) throw ForwardModelError("the reduced model found no equilibrium");
}

}  // namespace

ReducedForwardModel::ReducedForwardModel(std::shared_ptr<const ReducedModel> model,
                                         const std::vector<std::string>& markers,
                                         const std::vector<std::string>& actuators)
    : model_(std::move(model)), simulation_(model_), places_(*model_) {
  for (const std::string& name : markers) markers_.push_back(model_->full->marker_index(name));
  for (const std::string& name : actuators) actuators_.push_back(model_->full->actuator_index(name));
}

bool ReducedForwardModel::knows(const std::vector<double>& commands) const {
  for (std::size_t i = 0; i < commands.size(); ++i)
    if (!(commands[i] >= model_->box.min[i] && commands[i] <= model_->box.max[i])) return false;
  return true;
}

void ReducedForwardModel::start_at(const std::vector<double>& commands) {
  simulation_.reset();
  known_.clear();
  command(commands, simulation_);
  require_rest(simulation_.solve_equilibrium());
}

void ReducedForwardModel::move(const Eigen::VectorXd& commands) {
  for (std::size_t i = 0; i < actuators_.size(); ++i)
    simulation_.set_command(simulation_.actuators()[static_cast<std::size_t>(actuators_[i])]->name(),
                            commands[static_cast<Eigen::Index>(i)]);
}

void ReducedForwardModel::follow(const Eigen::VectorXd& commands) {
  Eigen::VectorXd from(commands.size());
  for (Eigen::Index i = 0; i < commands.size(); ++i)
    from[i] = simulation_.state().drives[static_cast<std::size_t>(actuators_[static_cast<std::size_t>(i)])].command;
  for (int stage = 1; stage <= kStages; ++stage) {
    move(stage == kStages ? commands : Eigen::VectorXd(from + (commands - from) * stage / kStages));
    require_rest(simulation_.solve_nearby());
  }
}

Prediction ReducedForwardModel::predict(const Eigen::VectorXd& commands, bool with_derivatives) {
  return answer(commands, with_derivatives, [&] {
    move(commands);
    require_rest(simulation_.solve_equilibrium());
  });
}

Prediction ReducedForwardModel::try_out(const Eigen::VectorXd& commands, bool with_derivatives) {
  return answer(commands, with_derivatives, [&] {
    const ReducedState before = simulation_.state();
    move(commands);
    const ReducedReport nearby = simulation_.solve_nearby();
    if (nearby.converged) return;
    if (!nearby.interrupted.empty()) throw ForwardModelInterrupted();
    simulation_.set_state(before);
    follow(commands);
  });
}

Prediction ReducedForwardModel::answer(const Eigen::VectorXd& commands, bool with_derivatives,
                                       const std::function<void()>& settle) {
  const ReducedState before = simulation_.state();
  Prediction prediction;
  try {
    if (!start_near(commands)) settle();
    if (with_derivatives) add_derivatives(prediction);
  } catch (...) {
    simulation_.set_state(before);
    throw;
  }
  remember(commands);
  prediction.markers_m = markers_m();
  if (corrected_at_.size() > 0) prediction.markers_m.reshaped() += offsets_m_ + slopes_ * (commands - corrected_at_);
  const std::vector<ActuatorReading> all = readings(simulation_.state().at.multipliers);
  prediction.tensions_n.resize(commands.size());
  prediction.slack.resize(commands.size());
  for (Eigen::Index i = 0; i < commands.size(); ++i) {
    const ActuatorReading& reading = all[static_cast<std::size_t>(actuators_[static_cast<std::size_t>(i)])];
    prediction.tensions_n[i] = reading.tension_n.value_or(0.0);
    prediction.slack[i] = reading.slack_m.value_or(0.0) * commands[i] / reading.commanded_length_m.value_or(1.0);
  }
  return prediction;
}

bool ReducedForwardModel::start_near(const Eigen::VectorXd& commands) {
  const auto nearest = std::min_element(known_.begin(), known_.end(), [&](const Known& a, const Known& b) {
    return (a.commands - commands).norm() < (b.commands - commands).norm();
  });
  if (nearest == known_.end()) return false;
  simulation_.set_state(nearest->state);
  return nearest->commands == commands;
}

void ReducedForwardModel::remember(const Eigen::VectorXd& commands) {
  const auto same = [&](const Known& known) { return known.commands == commands; };
  if (std::any_of(known_.begin(), known_.end(), same)) return;
  if (known_.size() == kReducedRemembered) known_.erase(known_.begin());
  known_.push_back({commands, simulation_.state()});
}

void ReducedForwardModel::answer_for(ReachProblem& problem) {
  for (std::size_t i = 0; i < actuators_.size(); ++i) {
    const auto own = static_cast<Eigen::Index>(i);
    const auto trained = static_cast<std::size_t>(actuators_[i]);
    problem.min[own] = std::max(problem.min[own], model_->box.min[trained]);
    problem.max[own] = std::min(problem.max[own], model_->box.max[trained]);
  }
  problem.trial = [this](const Eigen::VectorXd& commands, bool with_derivatives) {
    return try_out(commands, with_derivatives);
  };
  problem.model = [this](const Eigen::VectorXd& commands, bool with_derivatives) {
    return predict(commands, with_derivatives);
  };
}

Eigen::Matrix3Xd ReducedForwardModel::markers_m() {
  return places_.places_m(simulation_.state().at.q)(Eigen::all, markers_);
}

Eigen::MatrixXd ReducedForwardModel::named(const Eigen::MatrixXd& jacobian) const {
  Eigen::MatrixXd result(3 * static_cast<Eigen::Index>(markers_.size()), static_cast<Eigen::Index>(actuators_.size()));
  for (std::size_t m = 0; m < markers_.size(); ++m)
    result.middleRows<3>(3 * static_cast<Eigen::Index>(m)) = jacobian(Eigen::seqN(3 * markers_[m], 3), actuators_);
  return result;
}

void ReducedForwardModel::correct(const Eigen::VectorXd& commands, const Eigen::Matrix3Xd& markers_m,
                                  const Eigen::MatrixXd& jacobian) {
  corrected_at_.resize(0);
  const Prediction own = predict(commands, true);
  const Eigen::Matrix3Xd offsets_m = markers_m(Eigen::all, markers_) - own.markers_m;
  offsets_m_ = offsets_m.reshaped();
  slopes_ = named(jacobian) - own.marker_jacobian;
  corrected_at_ = commands;
}

std::vector<ActuatorReading> ReducedForwardModel::readings(const Eigen::VectorXd& multipliers) const {
  const Eigen::Matrix3Xd positions_m = simulation_.positions_m();
  std::vector<ActuatorReading> all;
  const double* first = multipliers.data();
  for (std::size_t i = 0; i < simulation_.actuators().size(); ++i) {
    const Actuator& actuator = *simulation_.actuators()[i];
    const std::size_t count = actuator.constraints().size();
    all.push_back(actuator.observe(positions_m, {first, first + count}, simulation_.state().drives[i]));
    first += count;
  }
  return all;
}

// A tension is linear in its actuator's multipliers.
void ReducedForwardModel::add_derivatives(Prediction& prediction) {
  const ReducedState& state = simulation_.state();
  const ReducedSensitivities change = reduced_sensitivities(*model_, state);
  if (!change.stable) throw ForwardModelError("the reduced model's equilibrium is not stable");
  const auto count = static_cast<Eigen::Index>(actuators_.size());
  prediction.marker_jacobian = named(places_.motions(state.at.q) * change.q);
  if (corrected_at_.size() > 0) prediction.marker_jacobian += slopes_;
  prediction.tension_jacobian = Eigen::MatrixXd::Zero(count, count);
  const std::vector<ActuatorReading> here = readings(state.at.multipliers);
  for (Eigen::Index j = 0; j < count; ++j) {
    const std::vector<ActuatorReading> there =
        readings(state.at.multipliers + change.multipliers.col(actuators_[static_cast<std::size_t>(j)]));
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto own = static_cast<std::size_t>(actuators_[static_cast<std::size_t>(i)]);
      prediction.tension_jacobian(i, j) = there[own].tension_n.value_or(0.0) - here[own].tension_n.value_or(0.0);
    }
  }
}

}  // namespace soft_robot_lab
