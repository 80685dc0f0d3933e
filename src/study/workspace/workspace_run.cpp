// SPDX-License-Identifier: BSD-3-Clause
#include "workspace_run.h"

#include <algorithm>

#include "control/workspace/walk.h"

namespace soft_robot_lab {
namespace {

using Json = nlohmann::ordered_json;

std::vector<double> list(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json json_of(const WorkspacePoint& point, const WorkspacePlan& plan, const Model& model) {
  Json result;
  result["snapped"] = point.snapped;
  for (Eigen::Index m = 0; m < point.markers_m.cols(); ++m)
    result["markers"][model.markers()[std::size_t(m)].name()]["position_m"] = list(point.markers_m.col(m));
  for (std::size_t a = 0; a < point.actuators.size(); ++a) {
    const ActuatorReading& reading = point.actuators[a];
    Json& actuator = result["actuators"][reading.name];
    if (reading.tension_n) actuator["tension_n"] = *reading.tension_n;
    if (reading.gauge_pressure_pa) actuator["gauge_pressure_pa"] = *reading.gauge_pressure_pa;
    if (reading.slack_m) actuator["slack_m"] = *reading.slack_m;
    actuator["jacobian_m"] = list(point.jacobian_m.col(static_cast<Eigen::Index>(a)));
  }
  result["least_singular_value_m"] = least_singular_value_m(point.jacobian_m, plan.ranges);
  return result;
}

TaskOutcome outcome_of(const WorkspacePoint& point, const StudyTask& task, const WorkspacePlan& plan,
                       const Model& model) {
  if (!point.failure.empty()) return {task.hash, TaskOutcome::State::failed, point.failure, "", 0.0};
  return {task.hash, TaskOutcome::State::good, "", json_of(point, plan, model).dump(), 0.0};
}

std::vector<bool> folded_points(const WorkspacePlan& plan, const Journal& journal) {
  std::vector<std::optional<Reached>> points;
  for (const StudyTask& task : plan.tasks) points.push_back(reached(plan, task, journal));
  std::vector<bool> folded(points.size(), false);
  for (const NeighbourPair& pair : plan.neighbours) {
    const auto& from = points[std::size_t(pair.from)];
    const auto& to = points[std::size_t(pair.to)];
    if (!from || !to) continue;
    const Eigen::VectorXd change = plan.commands.col(pair.to) - plan.commands.col(pair.from);
    if (folded_between(from->marker_m, from->jacobian_m, to->marker_m, to->jacobian_m, change))
      folded[std::size_t(pair.from)] = folded[std::size_t(pair.to)] = true;
  }
  return folded;
}

}  // namespace

std::optional<Reached> reached(const WorkspacePlan& plan, const StudyTask& task, const Journal& journal) {
  const std::optional<TaskOutcome> outcome = journal.find(task.hash);
  if (!outcome || outcome->result.empty()) return std::nullopt;
  const Json result = Json::parse(outcome->result);
  const auto vector = [](const Json& numbers) {
    return Eigen::Vector3d(numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>());
  };
  Reached point{vector(result.at("markers").at(plan.marker).at("position_m")),
                Eigen::MatrixXd(3, plan.commands.rows())};
  for (Eigen::Index a = 0; a < plan.commands.rows(); ++a)
    point.jacobian_m.col(a) =
        vector(result.at("actuators").at(plan.study.parameters[std::size_t(a)].name).at("jacobian_m"));
  return point;
}

void run_workspace(const WorkspacePlan& plan, const std::shared_ptr<const Model>& model, int threads, Journal& journal,
                   const std::function<bool(const WorkspaceProgress&)>& report) {
  WorkspaceWalk walk{model, model->marker_index(plan.marker), plan.commands, plan.starts, {}, threads, {}};
  for (const StudyTask& task : plan.tasks) walk.wanted.push_back(!journal.find(task.hash));
  const auto missing = static_cast<std::size_t>(std::count(walk.wanted.begin(), walk.wanted.end(), true));
  WorkspaceProgress progress{plan.tasks.size(), plan.tasks.size() - missing, 0};
  if (missing == 0) return;
  walk.found = [&](int point, const WorkspacePoint& found) {
    journal.add(outcome_of(found, plan.tasks[std::size_t(point)], plan, *model));
    ++progress.done;
    progress.failed += found.failure.empty() ? 0 : 1;
    return report(progress);
  };
  walk_workspace(walk);
}

ResultsTable workspace_table(const WorkspacePlan& plan, const Journal& journal) {
  ResultsTable table = results_table(plan.study, plan.tasks, journal);
  const std::vector<bool> folded = folded_points(plan, journal);
  table.results.emplace_back("folded");
  table.columns.emplace_back();
  for (std::size_t row = 0; row < folded.size(); ++row)
    table.columns.back().push_back(table.states[row] == "good" ? Json(bool(folded[row])) : Json());
  return table;
}

}  // namespace soft_robot_lab
