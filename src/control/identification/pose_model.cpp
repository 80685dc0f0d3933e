// SPDX-License-Identifier: BSD-3-Clause
#include "pose_model.h"

#include <algorithm>
#include <stdexcept>

#include "measured_weight.h"

namespace soft_robot_lab {
namespace {

constexpr int kStagesOfMove = 4;   // where friction makes the way count
constexpr int kFinestStages = 64;  // where one of them is too far for the solver

bool has_friction(const Simulation& simulation) {
  return std::any_of(simulation.actuators().begin(), simulation.actuators().end(),
                     [](const auto& actuator) { return !actuator->friction_contacts().empty(); });
}

std::vector<double> commands_of(const Simulation& simulation, const MeasuredPose& pose) {
  std::vector<double> commands;
  for (const auto& actuator : simulation.actuators()) {
    const CommandLimits limits = actuator->limits();
    const auto asked = pose.commands.find(actuator->name()), reached = pose.reached.find(actuator->name());
    if (reached != pose.reached.end())
      commands.push_back(std::clamp(reached->second, limits.min, limits.max));
    else
      commands.push_back(asked == pose.commands.end() ? limits.rest : asked->second);
  }
  return commands;
}

// Goes from equilibrium to equilibrium, with what derivatives have to know of the past.
class Walk {
 public:
  Walk(Simulation& simulation, std::vector<ModelParameter> parameters, bool derivatives)
      : simulation_(simulation),
        parameters_(std::move(parameters)),
        derivatives_(derivatives),
        friction_(has_friction(simulation)) {}

  void go(const std::vector<double>& to) {
    const std::vector<double> from = simulation_.state().commands();
    if (!friction_) {
      solve(from, to, 1.0);
      differentiate();
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
      differentiate();
      done += stage;
      stage = std::min({longest, 2.0 * stage, 1.0 - done});
    }
  }

  const Eigen::MatrixXd& jacobian() const { return jacobian_; }

 private:
  int solve(const std::vector<double>& from, const std::vector<double>& to, double fraction) {
    for (std::size_t i = 0; i < to.size(); ++i)
      simulation_.set_command(simulation_.actuators()[i]->name(),
                              fraction >= 1.0 - 1e-9 ? to[i] : from[i] + fraction * (to[i] - from[i]));
    const SolveReport report = simulation_.solve_equilibrium();
    if (!report.converged) throw std::runtime_error(report.message);
    return report.steps;
  }

  void differentiate() {
    if (!derivatives_) return;
    if (!friction_) slipped_m_.resize(0, 0);
    jacobian_ = simulation_.parameter_sensitivities(parameters_, slipped_m_);
  }

  Simulation& simulation_;
  std::vector<ModelParameter> parameters_;
  bool derivatives_, friction_;
  Eigen::MatrixXd slipped_m_, jacobian_;
};

PosePrediction read_markers(const Simulation& simulation, const MeasuredPose& pose, const Eigen::MatrixXd& jacobian) {
  PosePrediction prediction;
  const auto count = static_cast<Eigen::Index>(pose.markers.size());
  prediction.markers_m.resize(3, count);
  prediction.jacobian.resize(jacobian.size() > 0 ? 3 * count : 0, jacobian.cols());
  for (Eigen::Index m = 0; m < count; ++m) {
    const int index = simulation.marker_index(pose.markers[static_cast<std::size_t>(m)].name);
    prediction.markers_m.col(m) = simulation.marker_position(index);
    if (jacobian.size() > 0) prediction.jacobian.middleRows<3>(3 * m) = jacobian.middleRows<3>(3 * index);
  }
  return prediction;
}

}  // namespace

PoseModel::PoseModel(std::string scene, SceneOptions options, const std::vector<MeasuredPose>& poses)
    : scene_(std::move(scene)), options_(std::move(options)), poses_(poses) {
  const Scene loaded = load_scene(scene_, options_);
  for (const MeasuredPose& pose : poses) {
    for (const auto& [actuator, value] : pose.commands) {
      loaded.simulation->set_command(actuator, value);  // refuses what is out of range
    }
    for (const MeasuredMarker& marker : pose.markers) {
      loaded.simulation->marker_index(marker.name);
      require_finite(marker);
    }
  }
}

std::vector<PosePrediction> PoseModel::predict(const std::string& overrides, const Parameters& parameters) {
  SceneOptions options = options_;
  options.overrides = overrides;
  const Scene scene = load_scene(scene_, options);
  Simulation& simulation = *scene.simulation;
  const bool remember = !has_friction(simulation), warm = remember && last_.size() == poses_.size();
  Walk walk(simulation, parameters ? parameters(simulation) : std::vector<ModelParameter>{}, bool(parameters));
  if (!warm) walk.go(commands_of(simulation, MeasuredPose{}));
  std::vector<PosePrediction> predictions;
  std::vector<SimulationState> states;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    if (warm) simulation.set_state(last_[i]);
    walk.go(commands_of(simulation, poses_[i]));
    predictions.push_back(read_markers(simulation, poses_[i], walk.jacobian()));
    if (remember) states.push_back(simulation.state());
    if (remember) states.back().linearisation = nullptr;  // of another material
    if (remember) states.back().rest_residual.reset();
  }
  if (remember) last_ = std::move(states);
  return predictions;
}

}  // namespace soft_robot_lab
