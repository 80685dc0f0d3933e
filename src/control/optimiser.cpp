#include "soft_robot_lab/control/optimiser.h"

#include <chrono>
#include <cmath>
#include <ctime>
#include <sstream>
#include <stdexcept>

#include "control/search.h"

namespace soft_robot_lab {
namespace {

constexpr int kGaussNewtonIterations = 50;
constexpr int kRmspropIterations = 1000;
constexpr int kMostIterations = 1000000;

// Of this thread: other threads of a node are not the search's cost.
double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1.0e-9 * static_cast<double>(now.tv_nsec);
}

double wall_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

template <typename... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  throw std::invalid_argument(text.str());
}

void require_size(const char* field, Eigen::Index size, Eigen::Index count) {
  if (size != count) refuse(field, " has ", size, " entries, must have ", count, ", one per command");
}

std::vector<std::string> limits_met(const ReachProblem& problem, const Eigen::VectorXd& commands) {
  std::vector<std::string> met;
  for (Eigen::Index i = 0; i < commands.size(); ++i) {
    const double close = 1.0e-6 * (problem.max[i] - problem.min[i]);
    std::ostringstream text;
    if (commands[i] <= problem.min[i] + close) {
      text << problem.names[i] << " at its minimum " << problem.min[i];
    } else if (commands[i] >= problem.max[i] - close) {
      text << problem.names[i] << " at its maximum " << problem.max[i];
    } else {
      continue;
    }
    met.push_back(text.str());
  }
  return met;
}

std::string run_method(Search& search, const OptimiserOptions& options) {
  const auto limit = [&](int otherwise) { return options.max_iterations > 0 ? options.max_iterations : otherwise; };
  if (options.method == "rmsprop") return search_rmsprop(search, limit(kRmspropIterations));
  return search_gauss_newton(search, limit(kGaussNewtonIterations), options.tolerance_m);
}

}  // namespace

void ReachProblem::validate() const {
  const Eigen::Index count = start.size();
  if (!marker) refuse("marker: no model is given");
  if (!target_m.allFinite()) refuse("target_m [", target_m.transpose(), "] must be finite");
  if (count == 0) refuse("start has no entries, must have at least 1");
  require_size("min", min.size(), count);
  require_size("max", max.size(), count);
  require_size("names", static_cast<Eigen::Index>(names.size()), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!std::isfinite(min[i])) refuse("min of ", names[i], ": ", min[i], " must be finite");
    if (!std::isfinite(max[i])) refuse("max of ", names[i], ": ", max[i], " must be finite");
    if (min[i] >= max[i]) refuse("min of ", names[i], ": ", min[i], " must be below its max ", max[i]);
    if (!(start[i] >= min[i] && start[i] <= max[i])) {
      refuse("start of ", names[i], ": ", start[i], " is out of range [", min[i], ", ", max[i], "]");
    }
  }
}

void OptimiserOptions::validate() const {
  if (method != "gauss_newton" && method != "rmsprop") {
    refuse("method: '", method, "' is not one of gauss_newton, rmsprop");
  }
  if (max_iterations < 0 || max_iterations > kMostIterations) {
    refuse("max_iterations: ", max_iterations, " is out of range [0, ", kMostIterations, "]");
  }
  if (!std::isfinite(tolerance_m) || tolerance_m <= 0.0) {
    refuse("tolerance_m: ", tolerance_m, " is out of range (0, inf)");
  }
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
  if (const Evaluation* start = search.evaluate(problem.start, false)) {
    summary.initial_distance_m = start->distance_m;
    summary.stop_reason = run_method(search, options);
    summary.usable = true;
    summary.commands = search.best()->commands;
    summary.marker_m = search.best()->marker_m;
    summary.final_distance_m = search.best()->distance_m;
    summary.active_limits = limits_met(problem, summary.commands);
    summary.target_reached = summary.final_distance_m < options.tolerance_m;
  } else {
    summary.stop_reason = search.failure();
  }
  summary.iterations = search.iterations();
  summary.evaluations = search.evaluations();
  summary.cpu_s = thread_cpu_s() - cpu_start_s;
  summary.wall_s = wall_s() - wall_start_s;
  return summary;
}

}  // namespace soft_robot_lab
