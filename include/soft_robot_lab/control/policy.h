// SPDX-License-Identifier: BSD-3-Clause
// A policy: commands over time, read from and written to YAML, and played.
//   names: [left, right]
//   steps:
//     - {time_s: 2, values: [0.8, 1.1]}
#pragma once

#include <map>
#include <string>
#include <vector>

#include "forward_model.h"
#include "soft_robot_lab/mechanics/actuator.h"

namespace soft_robot_lab {

struct TimedCommandValues {
  double time_s = 0.0;         // after the start of the policy, when these values are reached
  std::vector<double> values;  // one per actuator, in the unit of its command
};

// Commands move linearly from step to step, and from the present commands to the first step.
struct CommandPolicy {
  std::vector<std::string> names;         // of actuators
  std::vector<TimedCommandValues> steps;  // in order of time
  std::string robot = {};                 // that it is for (name_of_robot); empty: any
};

// What a command may be; and how a message about one beyond that ends: which key of the scene moves the limit.
struct CommandRange : CommandLimits {
  std::string min_hint = {}, max_hint = {};
};
using CommandLimitsByName = std::map<std::string, CommandRange>;
CommandLimitsByName limits_of(const Simulation& simulation);

// Throws std::invalid_argument naming field, value and allowed range: no actuator or step, unknown or repeated names,
// times that do not grow, values that are not one per actuator or outside their limits.
void validate(const CommandPolicy& policy, const CommandLimitsByName& limits);

// Names of actuators are alike on many robots, forces are not. Throws std::invalid_argument where it is for another.
void require_robot(const CommandPolicy& policy, const std::string& robot);

// Throws SettingsError: file, line, key. What it says of actuators is checked by validate().
CommandPolicy load_policy(const std::string& path);
std::string policy_yaml(const CommandPolicy& policy);  // numbers keep all their digits

// Linear from the starting values to the first step, and from step to step.
class PolicyPlayer {
 public:
  PolicyPlayer(CommandPolicy policy, std::vector<double> start_values);

  const std::vector<std::string>& names() const { return policy_.names; }
  double end_s() const { return policy_.steps.back().time_s; }
  std::vector<double> values_at(double time_s) const;  // s after the start

 private:
  CommandPolicy policy_;
};

// Where the markers of a model rest after each step, one column per marker: from the simulation's present state along
// the policy, in rest states. Throws as ForwardModel::predict does.
std::vector<Eigen::Matrix3Xd> replay(Simulation& simulation, const CommandPolicy& policy,
                                     const std::vector<std::string>& markers);

}  // namespace soft_robot_lab
