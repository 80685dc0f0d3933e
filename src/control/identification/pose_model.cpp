// SPDX-License-Identifier: BSD-3-Clause
#include "pose_model.h"

#include <algorithm>
#include <stdexcept>

#include "measured_weight.h"
#include "pose_walk.h"

namespace soft_robot_lab {
namespace {

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

std::vector<PosePrediction> PoseModel::predict(const Overrides& overrides, const Parameters& parameters,
                                               const std::map<std::string, double>& backlash_m) {
  SceneOptions options = options_;
  options.overrides = overrides;
  const Scene scene = load_scene(scene_, options);
  Simulation& simulation = *scene.simulation;
  const bool remember = !has_friction(simulation), warm = remember && last_.size() == poses_.size();
  PoseWalk walk(simulation, parameters ? parameters(simulation) : std::vector<ModelParameter>{}, bool(parameters));
  DrivePlay play(simulation, backlash_m);
  const DriveEnds hanging = play.go(commands_of(simulation, MeasuredPose{}));
  if (!warm) walk.go(hanging);
  std::vector<PosePrediction> predictions;
  std::vector<SimulationState> states;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    if (warm) simulation.set_state(last_[i]);
    walk.go(play.go(commands_of(simulation, poses_[i])));
    predictions.push_back(read_markers(simulation, poses_[i], walk.jacobian()));
    if (remember) states.push_back(simulation.state());
    if (remember) states.back().linearisation = nullptr;  // of another material
    if (remember) states.back().rest_residual.reset();
  }
  if (remember) last_ = std::move(states);
  return predictions;
}

}  // namespace soft_robot_lab
