// SPDX-License-Identifier: BSD-3-Clause
#include "recorder.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace soft_robot_lab {

RecordingSettings read_recording_settings(const YamlNode& node) {
  RecordingSettings settings;
  settings.held_s = node.number("held_s", AllowedRange::positive());
  for (const YamlNode& time : node.sequence("film_at_s"))
    settings.film_at_s.push_back(time.as_number({0.0, settings.held_s}));
  if (settings.film_at_s.empty()) node.child("film_at_s").fail("empty; give at least one time");
  settings.known = Overrides(node.child("overrides"));
  return settings;
}

FitRequest read_fit_request(const YamlNode& node) {
  FitRequest request;
  request.model_error_m = node.number("model_error_m", AllowedRange::not_negative());
  for (const YamlNode& name : node.sequence("parameters")) request.parameters.push_back({name.as_text(), {}, {}, {}});
  return request;
}

Recorder::Recorder(const LabFiles& files, const RecordingSettings& settings, const ExperimentContext& context)
    : files_(files),
      settings_(settings),
      model_(load_scene(files.robot, context.scene_options(settings.known))),
      lab_(files.lab, context.scene_options()) {
  lab_.calibrate(files.balls);
}

MeasuredPose Recorder::hold(const Configuration& configuration) {
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
  for (const double at_s : settings_.film_at_s) {
    lab_.wait(std::max(0.0, start_s + at_s - lab_.time_s()));
    pose.seen.push_back(film(start_s));
  }
  lab_.wait(std::max(0.0, start_s + settings_.held_s - lab_.time_s()));
  pose.held_s = lab_.time_s() - start_s;
  pose.rest_from_s = settings_.film_at_s.back();
  pose.markers = pose.seen.back().markers;
  return pose;
}

std::vector<MeasuredPose> Recorder::record(const std::vector<Configuration>& configurations,
                                           const ExperimentContext& context, double from, double to) {
  std::vector<MeasuredPose> poses;
  for (const Configuration& configuration : configurations) {
    const double fraction = static_cast<double>(poses.size()) / static_cast<double>(configurations.size());
    context.report(from + fraction * (to - from), configuration.name);
    poses.push_back(hold(configuration));
  }
  return poses;
}

MarkersAt Recorder::film(double start_s) {
  const double from_s = lab_.time_s();
  MarkersAt seen;
  seen.markers = lab_.observe(marker_places(*model_.simulation));
  seen.time_s = 0.5 * (from_s + lab_.time_s()) - start_s;
  return seen;
}

double Recorder::rounded(const std::string& name, double command) const {
  for (const MotorSettings& motor : files_.lab.rig.motors)
    if (motor.name == name) return value_of(motor, std::round(steps_of(motor, command)));
  throw std::invalid_argument("the rig has no motor named '" + name + "'");
}

}  // namespace soft_robot_lab
