// SPDX-License-Identifier: BSD-3-Clause
#include "policy_run.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "settings/cpu_time.h"

namespace soft_robot_lab {
namespace {

// Counts the turns of each command's way.
class Reversals {
 public:
  int count = 0;

  void see(const Eigen::VectorXd& commands) {
    constexpr double still = 1.0e-4;
    if (last_.size() == 0) {
      last_ = commands;
      heading_ = Eigen::VectorXd::Zero(commands.size());
      return;
    }
    for (Eigen::Index i = 0; i < commands.size(); ++i) {
      const double move = commands[i] - last_[i];
      if (std::abs(move) < still) continue;
      if (move * heading_[i] < 0.0) ++count;
      heading_[i] = move;
      last_[i] = commands[i];
    }
  }

 private:
  Eigen::VectorXd last_, heading_;
};

}  // namespace

int PolicyRun::turns() const {
  constexpr double still_m = 1.0e-6;
  int count = 0;
  double heading_m = 0.0, last_m = distance_m.empty() ? 0.0 : distance_m.front();
  for (const double now_m : distance_m) {
    const double move_m = now_m - last_m;
    if (std::abs(move_m) < still_m) continue;
    if (move_m * heading_m < 0.0) ++count;
    heading_m = move_m;
    last_m = now_m;
  }
  return count;
}

double PolicyRun::largest_rise_m() const {
  double largest_m = 0.0, least_m = std::numeric_limits<double>::infinity();
  for (const double now_m : distance_m) {
    least_m = std::min(least_m, now_m);
    largest_m = std::max(largest_m, now_m - least_m);
  }
  return largest_m;
}

std::optional<double> PolicyRun::cpu_until_s(double distance_m_asked) const {
  for (size_t i = 0; i < distance_m.size(); ++i)
    if (distance_m[i] <= distance_m_asked) return cpu_s[i];
  return std::nullopt;
}

double PolicyRun::last_m() const { return distance_m.empty() ? summary.initial_distance_m : distance_m.back(); }

double PolicyRun::least_from_m(size_t iteration) const {
  if (distance_m.size() < iteration) return last_m();
  return *std::min_element(distance_m.begin() + static_cast<std::ptrdiff_t>(iteration) - 1, distance_m.end());
}

double PolicyRun::most_from_m(size_t iteration) const {
  if (distance_m.size() < iteration) return last_m();
  return *std::max_element(distance_m.begin() + static_cast<std::ptrdiff_t>(iteration) - 1, distance_m.end());
}

std::vector<OptimiserOptions> read_methods(const YamlNode& node) {
  std::vector<OptimiserOptions> methods;
  OptimiserOptions options;
  options.gradient_tolerance_m2 = node.number("gradient_tolerance_m2", AllowedRange::not_negative());
  const YamlNode iterations = node.child("methods");
  for (const std::string& method : iterations.keys()) {
    const std::vector<std::string>& known = optimiser_methods();
    if (std::find(known.begin(), known.end(), method) == known.end())
      iterations.fail("'" + method + "' is not a method");
    options.method = method;
    options.max_iterations = iterations.integer(method, 0, 1000000);
    methods.push_back(options);
  }
  if (methods.empty()) iterations.fail("names no method");
  return methods;
}

MethodSettings read_method_settings(const YamlNode& node, const std::string& config_folder) {
  return {read_reach_targets(config_folder + "/" + node.text("targets"), config_folder), read_methods(node)};
}

const PolicyRun* find(const TargetRuns& target, const std::string& method) {
  const auto found =
      std::find_if(target.runs.begin(), target.runs.end(), [&](const PolicyRun& run) { return run.method == method; });
  return found == target.runs.end() ? nullptr : &*found;
}

std::vector<TargetRuns> run_all(const MethodSettings& settings, const HangingRobot& robot,
                                const ExperimentContext& context) {
  const double count = static_cast<double>(settings.reach.targets.size() * settings.methods.size());
  double done = 0.0;
  std::vector<TargetRuns> all;
  for (const ReachTarget& target : settings.reach.targets) {
    all.push_back({target, {}});
    for (const OptimiserOptions& options : settings.methods) {
      context.report(done++ / count, "target " + target.name + ", " + options.method);
      const MarkerGoal goal{settings.reach.marker, target.position_m, 1.0};
      all.back().runs.push_back(run_policy_method(*robot.scene.simulation, robot.hanging, goal, options));
    }
  }
  return all;
}

PolicyRun run_policy_method(Simulation& simulation, const SimulationState& hanging, const MarkerGoal& goal,
                            const OptimiserOptions& options) {
  simulation.set_state(hanging);
  PolicyRun run;
  run.method = options.method;
  Reversals reversals;
  const double start_s = cpu_time_s();
  const PolicyAnswer answer =
      find_policy(simulation, {{{{goal}, 2.0, {}}}, {}, 0.0}, options,
                  [&](size_t, const std::vector<std::string>&, const OptimisationProgress& now) {
                    run.distance_m.push_back(now.distance_m);
                    run.cpu_s.push_back(cpu_time_s() - start_s);
                    run.commands.push_back(now.commands);
                    reversals.see(now.commands);
                    return true;
                  });
  run.summary = answer.summaries.front();
  run.reversals = reversals.count;
  return run;
}

}  // namespace soft_robot_lab
