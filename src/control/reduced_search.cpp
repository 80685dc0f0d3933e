// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_search.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "mechanics/reduced/snapshots.h"
#include "pose_problem.h"
#include "settings/cpu_time.h"
#include "soft_robot_lab/control/forward_model.h"
#include "soft_robot_lab/control/policy.h"

namespace soft_robot_lab {
namespace {

constexpr double kSameEnd_m = 1e-4;
// Each search on a corrected model leaves a part of its way to the next one: by the last two, or so much before that.
constexpr double kPartLeft = 0.5, kMostPartLeft = 0.9, kMostLeft_m = 5e-5;
constexpr int kRounds = 10;
constexpr int kStagesOfWay = 8;

double largest_distance_m(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a - b).colwise().norm().maxCoeff();
}

Eigen::Matrix3Xd markers_of(const Simulation& simulation) {
  Eigen::Matrix3Xd markers_m(3, static_cast<Eigen::Index>(simulation.markers().size()));
  for (int i = 0; i < static_cast<int>(markers_m.cols()); ++i) markers_m.col(i) = simulation.marker_position(i);
  return markers_m;
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

std::string too_far(double distance_m, double limit_m) {
  std::ostringstream text;
  text << "the full model rests " << 1e3 * distance_m << " mm from the search's end, more than the " << 1e3 * limit_m
       << " mm that the reduced model is trusted with";
  return text.str();
}

}  // namespace

std::string held_back(const ReachProblem& asked, const ReachProblem& trained, const Eigen::VectorXd& commands,
                      const Eigen::VectorXd& slack) {
  for (Eigen::Index i = 0; i < commands.size(); ++i) {
    const double close = 1e-6 * (trained.max[i] - trained.min[i]);
    const bool idle = slack[i] > 0.0;  // and so beyond its maximum
    if ((trained.min[i] > asked.min[i] && commands[i] <= trained.min[i] + close) ||
        (trained.max[i] < asked.max[i] && commands[i] >= trained.max[i] - close && !idle))
      return "the way leads beyond the commands of " + trained.names[static_cast<std::size_t>(i)] +
             " that the reduced model was trained for";
  }
  return "";
}

ReducedSearch::ReducedSearch(Simulation& simulation, const ReducedChoice& reduced)
    : simulation_(simulation), reduced_(reduced), limit_m_(reduced.trusted_m()) {}

OptimisationSummary ReducedSearch::find(const Pose& pose, ReachProblem problem, const OptimiserOptions& options,
                                        const ProgressCallback& progress) {
  const double start_s = cpu_time_s();
  const SimulationState before = simulation_.state();
  const std::vector<std::string> names = problem.names;
  OptimisationSummary summary;
  std::string why;
  try {
    why = search(pose, std::move(problem), options, progress, summary);
  } catch (const std::runtime_error& error) {  // ForwardModelError, or no stable shape
    why = error.what();
  }
  summary.cpu_s = cpu_time_s() - start_s;
  if (why.empty()) return summary;
  if (summary.usable && asked_to_end(simulation_)) {
    command_only(simulation_, before, names, summary);
    return summary;
  }
  simulation_.set_state(before);
  summary.usable = false;
  summary.stop_reason = why;
  return summary;
}

std::string ReducedSearch::search(const Pose& pose, ReachProblem problem, const OptimiserOptions& options,
                                  const ProgressCallback& progress, OptimisationSummary& summary) {
  lack_ = {};
  const SimulationState start = simulation_.state();
  const std::vector<std::string> markers = markers_of(pose);
  ReducedForwardModel model(reduced_.model, markers, problem.names);
  model.set_interrupt(simulation_.interrupt());
  if (!model.knows(start.commands())) return "the start is outside the commands that the reduced model was trained for";
  model.start_at(start.commands());
  if (largest_distance_m(model.markers_m(), markers_of(simulation_, markers)) > limit_m_)
    return "the reduced model starts in another shape";
  ReachProblem trained = problem;
  model.answer_for(trained);
  if ((trained.min.array() >= trained.max.array()).any() || (trained.start.array() < trained.min.array()).any() ||
      (trained.start.array() > trained.max.array()).any())
    return "the task's limits are outside the commands that the reduced model was trained for";
  summary = optimise(trained, options, progress);
  if (!summary.usable) return summary.stop_reason;
  std::string why = rest_beside(model, markers, summary);
  if (why.empty()) why = refine(model, markers, trained, options, progress, summary);
  if (why.empty()) why = held_back(problem, trained, summary.commands, model.predict(summary.commands, false).slack);
  if (why.empty()) why = require_one_end(start, problem.names, markers, summary, model);
  summary.final_distance_m = distance_m(problem, summary.markers_m);
  summary.target_reached = summary.final_distance_m < options.tolerance_m;
  return why;
}

std::string ReducedSearch::rest_beside(ReducedForwardModel& model, const std::vector<std::string>& markers,
                                       OptimisationSummary& summary) {
  model.predict(summary.commands, false);
  const SimulationState last = simulation_.state(), reduced = full_state(*reduced_.model, model.state(), last);
  const bool known = lack_.positions_m.size() > 0;
  SimulationState near = reduced;
  if (known) {
    near.positions_m += lack_.positions_m;
    near.element_multipliers_pa += lack_.element_multipliers_pa;
    near.constraint_multipliers += lack_.constraint_multipliers;
  }
  simulation_.set_state(near);
  const Eigen::Matrix3Xd before_m = markers_of(simulation_);
  bool found = simulation_.solve_equilibrium({0.0, true}).converged;
  if (!found && known) {
    simulation_.set_state(last);
    command(reduced.commands(), simulation_);
    found = simulation_.solve_equilibrium().converged;
  }
  const double estimate_m = std::sqrt((markers_of(simulation_) - before_m).colwise().squaredNorm().mean());
  if (!found) return "the full model found no rest state beside the search's end";
  if (estimate_m > limit_m_) return too_far(estimate_m, limit_m_);
  const SimulationState& full = simulation_.state();
  lack_.positions_m = full.positions_m - reduced.positions_m;
  lack_.element_multipliers_pa = full.element_multipliers_pa - reduced.element_multipliers_pa;
  lack_.constraint_multipliers = full.constraint_multipliers - reduced.constraint_multipliers;
  summary.markers_m = markers_of(simulation_, markers);
  return "";
}

std::string ReducedSearch::refine(ReducedForwardModel& model, const std::vector<std::string>& markers,
                                  ReachProblem& trained, const OptimiserOptions& options,
                                  const ProgressCallback& progress, OptimisationSummary& summary) {
  double part_left = kPartLeft, before_m = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    if (summary.stop_reason == "cancelled") return "";
    const OptimisationSummary last = summary;
    model.correct(last.commands, markers_of(simulation_), simulation_.marker_sensitivities());
    trained.start = last.commands;
    summary = optimise(trained, options, progress);
    const bool stuck = summary.commands == last.commands && summary.iterations > 0;
    summary.initial_distance_m = last.initial_distance_m;
    summary.iterations += last.iterations;
    summary.evaluations += last.evaluations;
    if (!summary.usable) return summary.stop_reason;
    if (stuck) break;
    if (summary.commands == last.commands) return "";
    const double way_m = largest_distance_m(last.markers_m, summary.markers_m);
    const std::string why = rest_beside(model, markers, summary);
    if (before_m > 0.0) part_left = std::min(kMostPartLeft, way_m / before_m);
    if (!why.empty() || way_m * part_left / (1.0 - part_left) <= kMostLeft_m) return why;
    before_m = way_m;
  }
  return "the search with the reduced model did not settle";
}

// Played from the start, as the policy will be: by the reduced model at once or in stages, or where neither says so, by
// the full one.
std::string ReducedSearch::require_one_end(const SimulationState& start, const std::vector<std::string>& names,
                                           const std::vector<std::string>& markers, const OptimisationSummary& summary,
                                           ReducedForwardModel& model) {
  model.predict(summary.commands, false);
  const Eigen::Matrix3Xd found_m = model.markers_m();
  Eigen::VectorXd way = summary.commands;
  for (Eigen::Index i = 0; i < way.size(); ++i)
    way[i] -=
        start.drives[static_cast<std::size_t>(simulation_.actuator_index(names[static_cast<std::size_t>(i)]))].command;
  for (const int stages : {1, kStagesOfWay}) {
    try {
      model.start_at(start.commands());
      for (int stage = 1; stage <= stages; ++stage) {
        const Eigen::VectorXd left = (1.0 - static_cast<double>(stage) / stages) * way;
        model.predict(summary.commands - left, false);
      }
      if (largest_distance_m(model.markers_m(), found_m) <= kSameEnd_m) return "";
    } catch (const ForwardModelError&) {
    }
  }
  const SimulationState there = simulation_.state();
  simulation_.set_state(start);
  const std::vector<double> values(summary.commands.data(), summary.commands.data() + summary.commands.size());
  const Eigen::Matrix3Xd played_m = replay(simulation_, {names, {{1.0, values}}}, markers).front();
  if (largest_distance_m(played_m, summary.markers_m) > kSameEnd_m)
    return "the body has more than one rest state at the search's end";
  simulation_.set_state(there);
  return "";
}

}  // namespace soft_robot_lab
