// SPDX-License-Identifier: BSD-3-Clause
#include "refinement.h"

#include <algorithm>
#include <queue>

#include "workspace_run.h"

namespace soft_robot_lab {
namespace {

// In shares of the commands' ranges.
double from_rest(const WorkspacePlan& plan, const Model& model, int point) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < plan.ranges.size(); ++i) {
    const double rest = model.actuators()[std::size_t(i)]->limits().rest;
    const double away = (plan.commands(i, point) - rest) / plan.ranges[i];
    sum += away * away;
  }
  return sum;
}

std::vector<double> gaps_m(const WorkspacePlan& plan, const Journal& journal) {
  std::vector<std::optional<Reached>> points;
  for (const StudyTask& task : plan.tasks) points.push_back(reached(plan, task, journal));
  std::vector<double> gaps;
  for (const NeighbourPair& pair : plan.neighbours) {
    const auto& from = points[std::size_t(pair.from)];
    const auto& to = points[std::size_t(pair.to)];
    gaps.push_back(from && to ? (to->marker_m - from->marker_m).norm() : 0.0);
  }
  return gaps;
}

void add_point(const Eigen::VectorXd& commands, int start, const StudySettings& study, const std::string& scene,
               const std::string& version, WorkspacePlan& plan) {
  StudyTask task{"", {commands.begin(), commands.end()}, 0};
  task.hash = request_hash(task_request(study, task), scene, version);
  plan.tasks.push_back(std::move(task));
  plan.commands.conservativeResize(Eigen::NoChange, plan.commands.cols() + 1);
  plan.commands.rightCols<1>() = commands;
  plan.starts.push_back(start);
}

}  // namespace

std::vector<int> points_between(const std::vector<double>& lengths, int count) {
  std::vector<int> points(lengths.size(), 0);
  std::priority_queue<std::pair<double, int>> parts;  // length of a part; of equal ones the first gap's
  for (std::size_t i = 0; i < lengths.size(); ++i)
    if (lengths[i] > 0.0) parts.emplace(lengths[i], -static_cast<int>(i));
  for (int added = 0; added < count && !parts.empty(); ++added) {
    const auto gap = static_cast<std::size_t>(-parts.top().second);
    parts.pop();
    if (++points[gap] < kMostBetween) parts.emplace(lengths[gap] / (points[gap] + 1), -static_cast<int>(gap));
  }
  return points;
}

void refine_workspace(WorkspacePlan& plan, const Model& model, int count, const std::string& version,
                      const Journal& journal) {
  const std::vector<int> between = points_between(gaps_m(plan, journal), count);
  const std::string scene = scene_hash(plan.study.scene, plan.study.arguments);
  StudySettings study = plan.study;  // the way to a point is part of its name
  study.arguments.insert(study.arguments.end(), {"--refine", std::to_string(count)});
  std::vector<NeighbourPair> neighbours;
  for (std::size_t gap = 0; gap < between.size(); ++gap) {
    auto [from, to] = plan.neighbours[gap];
    if (from_rest(plan, model, to) < from_rest(plan, model, from)) std::swap(from, to);
    const Eigen::VectorXd first = plan.commands.col(from), way = plan.commands.col(to) - first;
    for (int i = 1, before = from; i <= between[gap]; ++i) {
      add_point(first + i / (between[gap] + 1.0) * way, before, study, scene, version, plan);
      const int added = static_cast<int>(plan.tasks.size()) - 1;
      neighbours.push_back({before, added});
      before = from = added;
    }
    neighbours.push_back({from, to});
  }
  plan.neighbours = std::move(neighbours);
}

}  // namespace soft_robot_lab
