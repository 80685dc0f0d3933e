// SPDX-License-Identifier: BSD-3-Clause
#include "workspace_plan.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "settings/limits.h"
#include "settings/words.h"
#include "study/sweeps/sampling.h"

namespace soft_robot_lab {
namespace {

constexpr int kMostSamples = limits::kSamples;  // each is compared with all others

StudyParameter parameter_of(const WorkspaceSettings& settings, const Actuator& actuator) {
  const CommandLimits& limits = actuator.limits();
  StudyParameter parameter{actuator.name(), {}, limits.min, limits.max, settings.steps, false};
  for (const auto& [name, min, max] : settings.range) {
    if (name != actuator.name()) continue;
    if (!(min < max && min >= limits.min && max <= limits.max))
      throw std::invalid_argument("--range " + name + ": " + format_number(min) + " to " + format_number(max) +
                                  ", must rise and lie in " + format_number(limits.min) + " to " +
                                  format_number(limits.max));
    parameter.min = min;
    parameter.max = max;
  }
  return parameter;
}

// What decides a result beside the commands, and so is part of a task's name.
std::vector<std::string> arguments_of(const WorkspaceSettings& settings, const WorkspacePlan& plan) {
  std::vector<std::string> arguments = {"--marker", plan.marker};
  if (settings.samples > 0) {
    arguments.insert(arguments.end(), {"--samples", std::to_string(settings.samples)});
  } else {
    arguments.insert(arguments.end(), {"--steps", std::to_string(settings.steps)});
  }
  for (const StudyParameter& parameter : plan.study.parameters)
    arguments.push_back(parameter.name + " " + format_number(parameter.min) + " " + format_number(parameter.max));
  arguments.insert(arguments.end(), settings.set.begin(), settings.set.end());
  return arguments;
}

std::string marker_of(const WorkspaceSettings& settings, const Simulation& robot) {
  if (robot.markers().empty()) throw std::invalid_argument("markers: the robot has none, so nothing is reached");
  if (!settings.marker.empty()) return robot.markers()[std::size_t(robot.marker_index(settings.marker))].name();
  const auto tip = std::find_if(robot.markers().begin(), robot.markers().end(),
                                [](const Marker& marker) { return marker.name() == "tip"; });
  return (tip != robot.markers().end() ? *tip : robot.markers().back()).name();
}

StudySettings study_of(const WorkspaceSettings& settings, const Simulation& robot) {
  StudySettings study;
  study.program = "workspace";
  study.scene = std::filesystem::absolute(settings.robot).string();
  study.method = settings.samples > 0 ? SamplingMethod::sobol : SamplingMethod::grid;
  study.samples = settings.samples;
  study.seed = settings.seed;
  for (const auto& actuator : robot.actuators()) study.parameters.push_back(parameter_of(settings, *actuator));
  return study;
}

// The places on the grid that are nearest to the rest commands.
std::vector<int> rest_places(const StudySettings& study, const Simulation& robot) {
  std::vector<int> places;
  for (std::size_t i = 0; i < study.parameters.size(); ++i) {
    const StudyParameter& parameter = study.parameters[i];
    const double fraction = (robot.actuators()[i]->limits().rest - parameter.min) / (parameter.max - parameter.min);
    places.push_back(
        static_cast<int>(std::lround(std::clamp(fraction, 0.0, 1.0) * static_cast<double>(parameter.steps - 1))));
  }
  return places;
}

// Of samples their own starts, the only neighbours that are known to be near.
std::vector<NeighbourPair> pairs_of(const std::vector<int>& starts) {
  std::vector<NeighbourPair> pairs;
  for (int point = 0; point < static_cast<int>(starts.size()); ++point)
    if (starts[std::size_t(point)] != kFromRest) pairs.push_back({starts[std::size_t(point)], point});
  return pairs;
}

void find_starts(const Simulation& robot, WorkspacePlan& plan) {
  const Eigen::Index count = plan.ranges.size();
  if (plan.study.method == SamplingMethod::grid) {
    const std::vector<int> steps(static_cast<std::size_t>(count), plan.study.parameters.front().steps);
    plan.starts = grid_starts(steps, rest_places(plan.study, robot));
    plan.neighbours = grid_neighbours(steps);
    return;
  }
  Eigen::VectorXd rest(count);
  for (Eigen::Index i = 0; i < count; ++i) rest[i] = robot.actuators()[std::size_t(i)]->limits().rest;
  const Eigen::VectorXd per_range = plan.ranges.cwiseInverse();
  plan.starts = nearest_starts(per_range.asDiagonal() * plan.commands, per_range.cwiseProduct(rest));
  plan.neighbours = pairs_of(plan.starts);
}

void require_known(const WorkspaceSettings& settings, const Simulation& robot) {
  if (robot.actuators().empty()) throw std::invalid_argument("the robot has no actuators, so nothing moves it");
  for (const auto& [option, count] :
       {std::pair("--samples ", settings.samples), std::pair("--refine ", settings.refine)})
    if (count > kMostSamples)
      throw std::invalid_argument(option + std::to_string(count) + ", must be at most " + std::to_string(kMostSamples));
  for (const auto& range : settings.range) robot.actuator_index(std::get<0>(range));
}

}  // namespace

WorkspacePlan plan_workspace(const WorkspaceSettings& settings, const Simulation& robot, const std::string& version) {
  require_known(settings, robot);
  WorkspacePlan plan;
  plan.marker = marker_of(settings, robot);
  plan.study = study_of(settings, robot);
  plan.study.arguments = arguments_of(settings, plan);
  plan.tasks = make_tasks(plan.study, version);
  plan.even = plan.tasks.size();
  const auto count = static_cast<Eigen::Index>(plan.study.parameters.size());
  plan.ranges.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const CommandLimits& limits = robot.actuators()[std::size_t(i)]->limits();
    plan.ranges[i] = limits.max - limits.min;
  }
  plan.commands.resize(count, static_cast<Eigen::Index>(plan.tasks.size()));
  for (std::size_t task = 0; task < plan.tasks.size(); ++task)
    plan.commands.col(static_cast<Eigen::Index>(task)) =
        Eigen::Map<const Eigen::VectorXd>(plan.tasks[task].values.data(), count);
  find_starts(robot, plan);
  return plan;
}

}  // namespace soft_robot_lab
