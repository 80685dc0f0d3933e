// SPDX-License-Identifier: BSD-3-Clause
// A method's search for a policy, as it went.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/reach_targets.h"
#include "soft_robot_lab/control/find_policy.h"
#include "study/experiment.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

struct PolicyRun {
  std::string method;
  OptimisationSummary summary;
  std::vector<double> distance_m, cpu_s;  // after each iteration, and the thread's time until then
  std::vector<Eigen::VectorXd> commands;  // the same
  int reversals = 0;                      // of a command's direction, by more than 1e-4 each way

  int turns() const;  // of the distance, from falling to growing or back, by more than a micrometre each way
  double largest_rise_m() const;  // of the distance above the least before it
  double last_m() const;          // the distance at the end, which need not be the least
  // Of iterations from this one on, the first being 1; both are last_m() where there are none.
  double least_from_m(size_t iteration) const;
  double most_from_m(size_t iteration) const;
  // The first time at which it was as near, or nothing where it never was.
  std::optional<double> cpu_until_s(double distance_m_asked) const;
};

// What the settings of experiments that compare methods have in common.
// targets: robots/hammerbot/tasks/targets.yaml
// gradient_tolerance_m2: 1.0e-4
// methods: {pid: 100, rmsprop: 1000}
std::vector<OptimiserOptions> read_methods(const YamlNode& node);  // of the last two keys
struct MethodSettings {
  ReachTargets reach;
  std::vector<OptimiserOptions> methods;  // in the order of the settings
};
MethodSettings read_method_settings(const YamlNode& node, const std::string& config_folder);

struct TargetRuns {
  ReachTarget target;
  std::vector<PolicyRun> runs;  // in the order of the methods
};
const PolicyRun* find(const TargetRuns& target, const std::string& method);

std::vector<TargetRuns> run_all(const MethodSettings& settings, const HangingRobot& robot,
                                const ExperimentContext& context);

// From the rest state `hanging`.
PolicyRun run_policy_method(Simulation& simulation, const SimulationState& hanging, const MarkerGoal& goal,
                            const OptimiserOptions& options);

}  // namespace soft_robot_lab
