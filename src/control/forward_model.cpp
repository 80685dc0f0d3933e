// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/forward_model.h"

#include <algorithm>
#include <cmath>

namespace soft_robot_lab {
namespace {

constexpr double kStagesOfRange = 4.0;  // into so many a command's range would be cut; the simulation cuts further
constexpr double kShortTrial = 0.01;    // of a command's range
constexpr double kRoughTolerance = 1e-3;
constexpr size_t kRemembered = 8;  // equilibria to start from, beside the first

}  // namespace

bool asked_to_end(const Simulation& simulation) { return simulation.interrupt() && simulation.interrupt()(); }

ForwardModel::ForwardModel(Simulation& simulation, const std::vector<std::string>& markers,
                           const std::vector<std::string>& actuators)
    : simulation_(simulation) {
  for (const std::string& marker : markers) markers_.push_back(simulation.marker_index(marker));
  for (const std::string& name : actuators) actuators_.push_back(simulation.actuator_index(name));
}

const Actuator& ForwardModel::actuator(Eigen::Index command) const {
  return *simulation_.actuators()[static_cast<size_t>(actuators_[static_cast<size_t>(command)])];
}

Prediction ForwardModel::predict(const Eigen::VectorXd& commands, bool with_derivatives) {
  return answer(commands, with_derivatives, false);
}

Prediction ForwardModel::try_out(const Eigen::VectorXd& commands, bool with_derivatives) {
  return answer(commands, with_derivatives, true);
}

void ForwardModel::answer_for(ReachProblem& problem) {
  problem.model = [this](const Eigen::VectorXd& commands, bool with_derivatives) {
    return predict(commands, with_derivatives);
  };
  problem.trial = [this](const Eigen::VectorXd& commands, bool with_derivatives) {
    return try_out(commands, with_derivatives);
  };
}

Prediction ForwardModel::answer(const Eigen::VectorXd& commands, bool with_derivatives, bool trial) {
  const Eigen::Index count = static_cast<Eigen::Index>(actuators_.size());
  if (commands.size() != count) {
    throw std::invalid_argument("commands: " + std::to_string(commands.size()) + " given, must be " +
                                std::to_string(count));
  }
  Prediction prediction;
  const SimulationState last_good = simulation_.state();
  try {
    const bool there = start_near(commands);
    if (!(there && trial)) settle(commands, trial);
    if (with_derivatives) add_derivatives(prediction);
  } catch (...) {
    simulation_.set_state(last_good);
    throw;
  }
  remember(commands);
  prediction.markers_m.resize(3, static_cast<Eigen::Index>(markers_.size()));
  for (size_t m = 0; m < markers_.size(); ++m)
    prediction.markers_m.col(static_cast<Eigen::Index>(m)) = simulation_.marker_position(markers_[m]);
  prediction.tensions_n.resize(count);
  prediction.slack.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const ActuatorReading reading = simulation_.actuator_state(actuators_[static_cast<size_t>(i)]);
    prediction.tensions_n[i] = reading.tension_n.value_or(0.0);
    const double command_per_m = commands[i] / reading.commanded_length_m.value_or(1.0);
    prediction.slack[i] = reading.slack_m.value_or(0.0) * command_per_m;
  }
  return prediction;
}

double ForwardModel::distance(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const {
  double largest = 0.0;
  for (Eigen::Index i = 0; i < to.size(); ++i) {
    const CommandLimits& limits = actuator(i).limits();
    largest = std::max(largest, std::abs(to[i] - from[i]) / (limits.max - limits.min));
  }
  return largest;
}

bool ForwardModel::start_near(const Eigen::VectorXd& commands) {
  const auto nearest = std::min_element(known_.begin(), known_.end(), [&](const Known& a, const Known& b) {
    return distance(a.commands, commands) < distance(b.commands, commands);
  });
  if (nearest == known_.end()) return false;
  simulation_.set_state(nearest->state);
  return nearest->commands == commands;
}

void ForwardModel::remember(const Eigen::VectorXd& commands) {
  const auto same = std::find_if(known_.begin(), known_.end(), [&](const Known& k) { return k.commands == commands; });
  if (same != known_.end()) {
    same->state = simulation_.state();
    return;
  }
  if (known_.size() > kRemembered) known_.erase(known_.begin() + 1);
  known_.push_back({commands, simulation_.state()});
}

void ForwardModel::settle(const Eigen::VectorXd& commands, bool trial) {
  Eigen::VectorXd from(commands.size());
  for (Eigen::Index i = 0; i < commands.size(); ++i)
    from[i] = simulation_.state().drives[static_cast<size_t>(actuators_[static_cast<size_t>(i)])].command;
  double stages = std::ceil(std::max(1.0, kStagesOfRange * distance(from, commands)));
  if (!(stages <= 2.0 * kStagesOfRange)) stages = 1.0;  // beyond the limits, to be refused
  EquilibriumOptions options{0.0, false, false};        // nobody reads warnings of trials
  if (trial && distance(from, commands) > kShortTrial) options = {kRoughTolerance, true, false};
  for (double stage = 1.0; stage <= stages; ++stage) {
    const Eigen::VectorXd there =
        stage == stages ? commands : Eigen::VectorXd(from + stage / stages * (commands - from));
    for (Eigen::Index i = 0; i < commands.size(); ++i) simulation_.set_command(actuator(i).name(), there[i]);
    const SolveReport report = simulation_.solve_equilibrium(options);
    if (report.interrupted && asked_to_end(simulation_)) throw ForwardModelInterrupted();
    if (!report.converged) throw ForwardModelError(report.message);
  }
}

void ForwardModel::add_derivatives(Prediction& prediction) const {
  Eigen::MatrixXd markers, tensions;
  try {
    markers = simulation_.marker_sensitivities(&tensions);
  } catch (const std::runtime_error& error) {
    throw ForwardModelError(error.what());
  }
  prediction.marker_jacobian.resize(3 * static_cast<Eigen::Index>(markers_.size()),
                                    static_cast<Eigen::Index>(actuators_.size()));
  for (size_t m = 0; m < markers_.size(); ++m)
    prediction.marker_jacobian.middleRows<3>(3 * static_cast<Eigen::Index>(m)) =
        markers(Eigen::seqN(3 * markers_[m], 3), actuators_);
  prediction.tension_jacobian = tensions(actuators_, actuators_);
}

}  // namespace soft_robot_lab
