// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/optimiser.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <sstream>

#include "refuse.h"
#include "search.h"
#include "settings/limits.h"
#include "soft_robot_lab/control/forward_model.h"

namespace soft_robot_lab {
namespace {

// Of this thread: other threads of a node are not the search's cost.
double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1.0e-9 * static_cast<double>(now.tv_nsec);
}

double wall_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void require_size(const char* field, Eigen::Index size, Eigen::Index count) {
  if (size != count) refuse(field, " has ", size, " entries, must have ", count, ", one per command");
}

std::vector<std::string> limits_met(const ReachProblem& problem, const Evaluation& at) {
  std::vector<std::string> met;
  for (Eigen::Index i = 0; i < at.commands.size(); ++i) {
    const double close = 1.0e-6 * (problem.max[i] - problem.min[i]);
    const auto note = [&](const std::string& words, double limit, const char* unit) {
      std::ostringstream text;
      text << problem.names[i] << words << limit << unit;
      met.push_back(text.str());
    };
    const bool other = !problem.bound_words.empty() && !problem.bound_words[i].empty();
    const std::string why = other ? " (" + problem.bound_words[i] + ") " : " ";
    if (at.commands[i] <= problem.min[i] + close) note(" at its minimum" + why, problem.min[i], "");
    if (at.commands[i] >= problem.max[i] - close) note(" at its maximum" + why, problem.max[i], "");
    if (problem.max_tension_n.size() == 0) continue;
    if (at.prediction.tensions_n[i] > (1.0 - kTensionBand) * problem.max_tension_n[i])
      note(" near its largest tension ", problem.max_tension_n[i], " N");
  }
  return met;
}

std::string run_method(Search& search, const OptimiserOptions& options) {
  const auto limit = [&](int otherwise) { return options.max_iterations > 0 ? options.max_iterations : otherwise; };
  if (options.method == "gauss_newton") return search_gauss_newton(search, limit(60), options.tolerance_m);
  if (options.method == "rmsprop") return search_rmsprop(search, limit(1000), options.gradient_tolerance_m2);
  if (options.method == "pid") return search_pid(search, limit(100));
  if (options.method == "pid_projected") return search_pid_projected(search, limit(1000), options.tolerance_m);
  return search_by_population(search, options.method, limit(50), options.population, options.seed, options.tolerance_m);
}

void require_bounds(const ReachProblem& problem) {
  for (Eigen::Index i = 0; i < problem.start.size(); ++i) {
    const std::string& name = problem.names[i];
    const double min = problem.min[i], max = problem.max[i], start = problem.start[i];
    if (!std::isfinite(min)) refuse("min of ", name, ": ", min, " must be finite");
    if (!std::isfinite(max)) refuse("max of ", name, ": ", max, " must be finite");
    if (min >= max) refuse("min of ", name, ": ", min, " must be below its max ", max);
    if (!(start >= min && start <= max))
      refuse("start of ", name, ": ", start, " is out of range [", min, ", ", max, "]");
    if (problem.max_tension_n.size() > 0 && !(problem.max_tension_n[i] > 0.0))
      refuse("max_tension_n of ", name, ": ", problem.max_tension_n[i], " is out of range (0, inf]");
  }
}

}  // namespace

void ReachProblem::validate() const {
  const Eigen::Index count = start.size();
  if (!model) refuse("model: none is given");
  if (goals.empty()) refuse("goals: none is given");
  for (const Goal& goal : goals) {
    if (!goal.target_m.allFinite()) refuse("target_m [", goal.target_m.transpose(), "] must be finite");
    if (!(goal.weight > 0.0 && std::isfinite(goal.weight)))
      refuse("weight: ", goal.weight, " is out of range (0, inf)");
  }
  if (count == 0) refuse("start has no entries, must have at least 1");
  require_size("min", min.size(), count);
  require_size("max", max.size(), count);
  require_size("names", static_cast<Eigen::Index>(names.size()), count);
  if (!bound_words.empty()) require_size("bound_words", static_cast<Eigen::Index>(bound_words.size()), count);
  if (max_tension_n.size() > 0) require_size("max_tension_n", max_tension_n.size(), count);
  if (!(effort_m >= 0.0 && std::isfinite(effort_m))) refuse("effort_m: ", effort_m, " is out of range [0, inf)");
  if (effort_m > 0.0) require_size("rest", rest.size(), count);
  if (!rest.allFinite()) refuse("rest [", rest.transpose(), "] must be finite");
  require_bounds(*this);
}

const std::vector<std::string>& optimiser_methods() {
  static const std::vector<std::string> methods = {"gauss_newton",  "rmsprop", "pid",
                                                   "pid_projected", "cma_es",  "differential_evolution"};
  return methods;
}

void OptimiserOptions::validate() const {
  const std::vector<std::string>& known = optimiser_methods();
  if (std::find(known.begin(), known.end(), method) == known.end()) {
    std::string names;
    for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
    refuse("method: '", method, "' is not one of ", names);
  }
  if (max_iterations < 0 || max_iterations > limits::kIterations) {
    refuse("max_iterations: ", max_iterations, " is out of range [0, ", limits::kIterations, "]");
  }
  if (!std::isfinite(tolerance_m) || tolerance_m <= 0.0) {
    refuse("tolerance_m: ", tolerance_m, " is out of range (0, inf)");
  }
  if (!(std::isfinite(gradient_tolerance_m2) && gradient_tolerance_m2 >= 0.0)) {
    refuse("gradient_tolerance_m2: ", gradient_tolerance_m2, " is out of range [0, inf)");
  }
  if (population < 5 || population > 1000) refuse("population: ", population, " is out of range [5, 1000]");
}

OptimisationSummary optimise(const ReachProblem& problem, const OptimiserOptions& options,
                             const ProgressCallback& progress) {
  problem.validate();
  options.validate();
  const double cpu_start_s = thread_cpu_s();
  const double wall_start_s = wall_s();

  OptimisationSummary summary;
  summary.commands = problem.start;
  Search search(problem, progress);
  const Evaluation* start = nullptr;
  try {
    start = search.evaluate(problem.start, false);
    if (start && start->allowed) {
      summary.initial_distance_m = start->distance_m;
      summary.usable = true;
      summary.stop_reason = run_method(search, options);
    }
  } catch (const ForwardModelInterrupted&) {
    summary.stop_reason = kCancelled;
  }
  if (summary.usable) {
    summary.commands = search.best()->commands;
    summary.markers_m = search.best()->prediction.markers_m;
    summary.final_distance_m = search.best()->distance_m;
    summary.active_limits = limits_met(problem, *search.best());
    summary.target_reached = summary.final_distance_m < options.tolerance_m;
  } else if (summary.stop_reason.empty()) {
    summary.stop_reason = start ? "a tension is beyond its limit at the start" : search.failure();
  }
  summary.iterations = search.iterations();
  summary.evaluations = search.evaluations();
  summary.cpu_s = thread_cpu_s() - cpu_start_s;
  summary.wall_s = wall_s() - wall_start_s;
  return summary;
}

}  // namespace soft_robot_lab
