#include "experiment/policy_run.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "soft_robot_lab/settings/cpu_time.h"

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

MethodIterations read_iterations(const SettingsNode& node) {
  MethodIterations iterations;
  for (const std::string& method : node.keys()) {
    const std::vector<std::string>& known = optimiser_methods();
    if (std::find(known.begin(), known.end(), method) == known.end()) node.fail("'" + method + "' is not a method");
    iterations.emplace_back(method, node.integer(method, 0, 1000000));
  }
  return iterations;
}

PolicyRun run_policy_method(Simulation& simulation, const SimulationState& hanging, const MarkerGoal& goal,
                            const std::string& method, int iterations) {
  simulation.set_state(hanging);
  PolicyRun run;
  run.method = method;
  OptimiserOptions options;
  options.method = method;
  options.max_iterations = iterations;
  Reversals reversals;
  const double start_s = cpu_time_s();
  const PolicyAnswer answer =
      find_policy(simulation, {{{{goal}, 2.0, {}}}, {}, 0.0}, options,
                  [&](size_t, const std::vector<std::string>&, const OptimisationProgress& now) {
                    run.distance_m.push_back(now.distance_m);
                    run.cpu_s.push_back(cpu_time_s() - start_s);
                    reversals.see(now.commands);
                    return true;
                  });
  run.summary = answer.summaries.front();
  run.reversals = reversals.count;
  return run;
}

}  // namespace soft_robot_lab
