// A policy as commands over time.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "soft_robot_lab/ros/messages.h"
#include "soft_robot_lab/sim/actuator.h"

namespace soft_robot_lab {

using CommandLimitsByName = std::map<std::string, CommandLimits>;

// Throws std::invalid_argument naming field, value and allowed range: no actuator or step, unknown or repeated names,
// times that do not grow, values that are not one per actuator or outside their limits.
void validate(const Policy& policy, const CommandLimitsByName& limits);

// Linear from the starting values to the first step, and from step to step.
class PolicyPlayer {
 public:
  PolicyPlayer(Policy policy, std::vector<double> start_values);

  const std::vector<std::string>& names() const { return policy_.names; }
  double end_s() const { return policy_.steps.back().time_s; }
  std::vector<double> values_at(double time_s) const;  // s after the start

 private:
  Policy policy_;
};

}  // namespace soft_robot_lab
