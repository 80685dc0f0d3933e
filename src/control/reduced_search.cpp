// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_search.h"

#include <algorithm>
#include <cmath>

#include "pose_problem.h"
#include "settings/cpu_time.h"
#include "soft_robot_lab/control/forward_model.h"

namespace soft_robot_lab {
namespace {

constexpr double kSameEnd_m = 1e-4;

double largest_distance_m(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

Eigen::Matrix3Xd markers_of(const Simulation& simulation, const std::vector<std::string>& names) {
  Eigen::Matrix3Xd markers_m(3, static_cast<Eigen::Index>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i)
    markers_m.col(static_cast<Eigen::Index>(i)) = simulation.marker_position(simulation.marker_index(names[i]));
  return markers_m;
}

// Weighted root mean square, as a search has it.
double distance_m(const ReachProblem& problem, const Eigen::Matrix3Xd& markers_m) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t k = 0; k < problem.goals.size(); ++k) {
    const Goal& goal = problem.goals[k];
    sum += goal.weight * (goal.target_m - markers_m.col(static_cast<Eigen::Index>(k))).squaredNorm();
    weights += goal.weight;
  }
  return std::sqrt(sum / weights);
}

// A command that the training holds back, where the task would let it go on.
std::string held_back(const ReachProblem& asked, const ReachProblem& trained, const Eigen::VectorXd& commands) {
  for (Eigen::Index i = 0; i < commands.size(); ++i) {
    const double close = 1e-6 * (trained.max[i] - trained.min[i]);
    if ((trained.min[i] > asked.min[i] && commands[i] <= trained.min[i] + close) ||
        (trained.max[i] < asked.max[i] && commands[i] >= trained.max[i] - close))
      return "the way leads beyond the commands of " + trained.names[static_cast<std::size_t>(i)] +
             " that the reduced model was trained for";
  }
  return "";
}

}  // namespace

ReducedSearch::ReducedSearch(Simulation& simulation, const ReducedChoice& reduced)
    : simulation_(simulation),
      reduced_(reduced),
      audit_(*reduced.model, simulation.model()),
      limit_m_(reduced.trusted_m()) {}

OptimisationSummary ReducedSearch::find(const Pose& pose, ReachProblem problem, const OptimiserOptions& options,
                                        const ProgressCallback& progress) {
  const double start_s = cpu_time_s();
  const SimulationState before = simulation_.state();
  OptimisationSummary summary;
  std::string why;
  try {
    why = search(pose, std::move(problem), options, progress, summary);
  } catch (const ForwardModelError& error) {
    why = error.what();
  }
  summary.cpu_s = cpu_time_s() - start_s;
  if (why.empty()) return summary;
  simulation_.set_state(before);
  summary.usable = false;
  summary.stop_reason = why;
  return summary;
}

std::string ReducedSearch::search(const Pose& pose, ReachProblem problem, const OptimiserOptions& options,
                                  const ProgressCallback& progress, OptimisationSummary& summary) {
  const std::vector<double> start = simulation_.state().commands();
  const std::vector<std::string> markers = markers_of(pose);
  ReducedForwardModel model(reduced_.model, markers, problem.names);
  if (!model.knows(start)) return "the start is outside the commands that the reduced model was trained for";
  model.start_at(start);
  if (largest_distance_m(model.markers_m(), markers_of(simulation_, markers)) > limit_m_)
    return "the reduced model starts in another shape";
  ReachProblem trained = problem;
  model.answer_for(trained);
  if ((trained.min.array() >= trained.max.array()).any() || (trained.start.array() < trained.min.array()).any() ||
      (trained.start.array() > trained.max.array()).any())
    return "the task's limits are outside the commands that the reduced model was trained for";
  summary = optimise(trained, options, progress);
  if (!summary.usable) return summary.stop_reason;
  std::string why = correct(model, trained, options, progress, summary);
  if (why.empty()) why = held_back(problem, trained, summary.commands);
  if (why.empty()) why = require_one_end(start, summary, model);
  if (why.empty()) why = settle(model, markers, summary);
  summary.final_distance_m = distance_m(problem, summary.markers_m);
  summary.target_reached = summary.final_distance_m < options.tolerance_m;
  return why;
}

std::string ReducedSearch::correct(ReducedForwardModel& model, ReachProblem& trained, const OptimiserOptions& options,
                                   const ProgressCallback& progress, OptimisationSummary& summary) {
  model.predict(summary.commands, false);
  const AuditResult audit = audit_.at_rest(model.state());
  if (!audit.found || audit.estimate_m > limit_m_) return "the reduced model failed its audit at the search's end";
  const Eigen::MatrixXd jacobian = audit_.sensitivities(model.state(), audit);
  if (jacobian.size() == 0) return "the full model is not stable at the search's end";
  model.correct(summary.commands, audit.markers_m, jacobian);
  const SimulationState here = full_state(*reduced_.model, model.state(), {});
  lack_.positions_m = audit.positions_m - here.positions_m;
  lack_.element_multipliers_pa = audit.element_multipliers_pa - here.element_multipliers_pa;
  lack_.constraint_multipliers = audit.constraint_multipliers - here.constraint_multipliers;
  trained.start = summary.commands;
  const OptimisationSummary first = summary;
  if (first.stop_reason == "cancelled") return "";
  summary = optimise(trained, options, progress);
  summary.initial_distance_m = first.initial_distance_m;
  summary.iterations += first.iterations;
  summary.evaluations += first.evaluations;
  return summary.usable ? "" : summary.stop_reason;
}

// Played from the start, as the policy will be.
std::string ReducedSearch::require_one_end(const std::vector<double>& start, const OptimisationSummary& summary,
                                           ReducedForwardModel& model) const {
  model.start_at(start);
  const Eigen::Matrix3Xd played_m = model.predict(summary.commands, false).markers_m;
  return largest_distance_m(played_m, summary.markers_m) <= kSameEnd_m
             ? ""
             : "the reduced model has more than one rest state at the search's end";
}

std::string ReducedSearch::settle(const ReducedForwardModel& model, const std::vector<std::string>& markers,
                                  OptimisationSummary& summary) {
  SimulationState there = full_state(*reduced_.model, model.state(), simulation_.state());
  there.positions_m += lack_.positions_m;
  there.element_multipliers_pa += lack_.element_multipliers_pa;
  there.constraint_multipliers += lack_.constraint_multipliers;
  simulation_.set_state(there);
  const SolveReport report = simulation_.solve_equilibrium();
  if (!report.converged) return "no equilibrium at the search's end: " + report.message;
  const Eigen::Matrix3Xd expected_m = summary.markers_m;
  summary.markers_m = markers_of(simulation_, markers);
  return largest_distance_m(expected_m, summary.markers_m) <= 2.0 * limit_m_
             ? ""
             : "the search's end is another shape of the full model";
}

}  // namespace soft_robot_lab
