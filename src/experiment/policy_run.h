// A method's search for a policy, as it went.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "soft_robot_lab/control/find_policy.h"
#include "soft_robot_lab/experiment/experiment.h"
#include "soft_robot_lab/settings/settings_node.h"

namespace soft_robot_lab {

struct PolicyRun {
  std::string method;
  OptimisationSummary summary;
  std::vector<double> distance_m, cpu_s;  // after each iteration, and the thread's time until then
  int reversals = 0;                      // of a command's direction, by more than 1e-4 each way

  int turns() const;  // of the distance, from falling to growing or back, by more than a micrometre each way
  double largest_rise_m() const;  // of the distance above the least before it
  // The first time at which it was as near, or nothing where it never was.
  std::optional<double> cpu_until_s(double distance_m_asked) const;
};

using MethodIterations = std::vector<std::pair<std::string, int>>;  // 0: the method's own
MethodIterations read_iterations(const SettingsNode& node);         // a map of methods

// From the rest state `hanging`.
PolicyRun run_policy_method(Simulation& simulation, const SimulationState& hanging, const MarkerGoal& goal,
                            const std::string& method, int iterations);

}  // namespace soft_robot_lab
