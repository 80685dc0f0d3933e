// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/find_policy.h"

#include <optional>
#include <sstream>

#include "pose_problem.h"
#include "reduced_search.h"
#include "soft_robot_lab/control/forward_model.h"

namespace soft_robot_lab {
namespace {

// Leaves the simulation at the answer, on the way on which the policy is played.
void go_to_answer(Simulation& simulation, const SimulationState& before, const Pose& pose,
                  const std::vector<std::string>& names, OptimisationSummary& summary) {
  simulation.set_state(before);
  const Eigen::Matrix3Xd found_m = summary.markers_m;
  const std::vector<double> values(summary.commands.data(), summary.commands.data() + summary.commands.size());
  summary.markers_m = replay(simulation, {names, {{pose.duration_s, values}}}, markers_of(pose)).front();
  const double apart_m = (summary.markers_m - found_m).colwise().norm().maxCoeff();
  constexpr double same_m = 1.0e-4;
  if (apart_m <= same_m) return;
  summary.usable = false;
  std::ostringstream text;
  text << summary.stop_reason << ", but played from the start it ends " << 1.0e3 * apart_m
       << " mm elsewhere: the body has more than one rest state there";
  summary.stop_reason = text.str();
}

OptimisationSummary find_step(Simulation& simulation, const Pose& pose, ReachProblem problem,
                              const OptimiserOptions& options, const ProgressCallback& progress) {
  const SimulationState before = simulation.state();
  ForwardModel model(simulation, markers_of(pose), problem.names);
  model.answer_for(problem);
  OptimisationSummary summary = optimise(problem, options, progress);
  if (!summary.usable) return summary;
  try {
    go_to_answer(simulation, before, pose, problem.names, summary);
  } catch (const ForwardModelInterrupted&) {
    command_only(simulation, before, problem.names, summary);
  } catch (const ForwardModelError& error) {
    summary.usable = false;
    summary.stop_reason += std::string(", but it cannot be played from the start: ") + error.what();
  }
  return summary;
}

// All actuators, at each step as commanded then.
void add_step(const Simulation& simulation, double time_s, CommandPolicy& policy) {
  policy.names.clear();
  for (const auto& actuator : simulation.actuators()) policy.names.push_back(actuator->name());
  policy.steps.push_back({time_s, simulation.state().commands()});
}

}  // namespace

void count_as_reached(PolicyAnswer& answer) {
  for (OptimisationSummary& summary : answer.summaries)
    summary.target_reached = summary.usable && summary.final_distance_m < kReached_m;
}

PolicyAnswer find_policy(Simulation& simulation, const PolicyTask& task, const OptimiserOptions& options,
                         const PoseProgress& progress, const ReducedChoice* reduced) {
  options.validate();
  require_task(simulation, task);
  pose_problem(simulation, task, task.poses.front());  // refuses what the bounds make impossible
  // A failure is found again, and reported, by the first evaluation.
  simulation.solve_equilibrium();
  PolicyAnswer answer;
  double time_s = 0.0;
  bool cancelled = false;
  std::optional<ReducedSearch> fast;
  if (reduced) fast.emplace(simulation, *reduced);
  for (size_t i = 0; i < task.poses.size() && !cancelled; ++i) {
    const ReachProblem problem = pose_problem(simulation, task, task.poses[i]);
    const auto show = [&](const OptimisationProgress& now) {
      cancelled = progress && !progress(i, problem.names, now);
      return !cancelled;
    };
    OptimisationSummary found;
    if (fast) found = fast->find(task.poses[i], problem, options, show);
    if (fast) answer.full_because.push_back(found.usable ? "" : found.stop_reason);
    if (!found.usable) found = find_step(simulation, task.poses[i], problem, options, show);
    cancelled = cancelled || asked_to_end(simulation);
    answer.summaries.push_back(std::move(found));
    if (!answer.summaries.back().usable) break;
    time_s += task.poses[i].duration_s;
    add_step(simulation, time_s, answer.policy);
  }
  answer.success = answer.policy.steps.size() == task.poses.size();
  return answer;
}

}  // namespace soft_robot_lab
