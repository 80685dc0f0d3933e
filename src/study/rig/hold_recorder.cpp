// SPDX-License-Identifier: BSD-3-Clause
#include "hold_recorder.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace soft_robot_lab {

FitRecording read_fit_recording(const YamlNode& node, const ExperimentContext& context) {
  FitRecording recording{read_lab_files(node, context), read_configurations(node)};
  recording.held_s = node.number("held_s", AllowedRange::positive());
  for (const YamlNode& time : node.sequence("film_at_s"))
    recording.film_at_s.push_back(time.as_number({0.0, recording.held_s}));
  recording.known = Overrides(node.child("overrides"));
  recording.request.model_error_m = node.number("model_error_m", AllowedRange::not_negative());
  for (const YamlNode& name : node.sequence("parameters"))
    recording.request.parameters.push_back({name.as_text(), {}, {}, {}});
  return recording;
}

HoldRecorder::HoldRecorder(const FitRecording& recording, const ExperimentContext& context)
    : recording_(recording),
      model_(load_scene(recording.files.robot, context.scene_options(recording.known))),
      lab_(recording.files.lab, context.scene_options()) {
  lab_.calibrate(recording.files.balls);
}

MeasuredPose HoldRecorder::hold(const Configuration& configuration) {
  Simulation& model = *model_.simulation;
  std::vector<std::string> names;
  for (const auto& actuator : model.actuators()) names.push_back(actuator->name());
  for (std::size_t i = 0; i < names.size(); ++i) model.set_command(names[i], configuration.commands.at(i));
  if (const SolveReport rest = model.solve_equilibrium(); !rest.converged)
    throw std::runtime_error("the model finds no rest: " + rest.message);
  const double start_s = lab_.time_s();
  lab_.command(names, configuration.commands);
  MeasuredPose pose;
  for (std::size_t i = 0; i < names.size(); ++i) pose.commands[names[i]] = rounded(names[i], configuration.commands[i]);
  for (const double at_s : recording_.film_at_s) {
    lab_.wait(std::max(0.0, start_s + at_s - lab_.time_s()));
    pose.seen.push_back(film(start_s));
  }
  lab_.wait(std::max(0.0, start_s + recording_.held_s - lab_.time_s()));
  pose.held_s = lab_.time_s() - start_s;
  pose.rest_from_s = recording_.film_at_s.back();
  pose.markers = pose.seen.back().markers;
  return pose;
}

MarkersAt HoldRecorder::film(double start_s) {
  const double from_s = lab_.time_s();
  MarkersAt seen;
  seen.markers = lab_.observe(marker_places(*model_.simulation));
  seen.time_s = 0.5 * (from_s + lab_.time_s()) - start_s;
  return seen;
}

double HoldRecorder::rounded(const std::string& name, double command) const {
  for (const MotorSettings& motor : recording_.files.lab.rig.motors)
    if (motor.name == name) return value_of(motor, std::round(steps_of(motor, command)));
  throw std::invalid_argument("the rig has no motor named '" + name + "'");
}

std::vector<MeasuredPose> HoldRecorder::hold_all(const std::vector<Configuration>& configurations,
                                                 const ExperimentContext& context, double from, double to) {
  std::vector<MeasuredPose> poses;
  for (const Configuration& configuration : configurations) {
    const double fraction = static_cast<double>(poses.size()) / static_cast<double>(configurations.size());
    context.report(from + fraction * (to - from), configuration.name);
    poses.push_back(hold(configuration));
  }
  return poses;
}

}  // namespace soft_robot_lab
