#include "soft_robot_lab/ros/policy_player.h"

#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace soft_robot_lab {
namespace {

template <typename... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream message;
  (message << ... << parts);
  throw std::invalid_argument(message.str());
}

std::string known_names(const CommandLimitsByName& limits) {
  std::string names;
  for (const auto& [name, unused] : limits) names += (names.empty() ? "" : ", ") + name;
  return names;
}

void validate_names(const std::vector<std::string>& names, const CommandLimitsByName& limits) {
  if (names.empty()) refuse("policy.names: empty; name at least one of ", known_names(limits));
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (limits.count(name) == 0) refuse("policy.names: '", name, "' is not one of ", known_names(limits));
    if (!seen.insert(name).second) refuse("policy.names: '", name, "' is given twice");
  }
}

void validate_step(const Policy& policy, size_t index, const CommandLimitsByName& limits) {
  const PolicyStep& step = policy.steps[index];
  const double earliest_s = index == 0 ? 0.0 : policy.steps[index - 1].time_s;
  if (!std::isfinite(step.time_s) || step.time_s < earliest_s) {
    refuse("policy.steps[", index, "].time_s: ", step.time_s, " is not in [", earliest_s, ", inf)");
  }
  if (step.values.size() != policy.names.size()) {
    refuse("policy.steps[", index, "].values: ", step.values.size(), " values for ", policy.names.size(), " names");
  }
  for (size_t i = 0; i < step.values.size(); ++i) {
    const CommandLimits& range = limits.at(policy.names[i]);
    if (!(step.values[i] >= range.min && step.values[i] <= range.max)) {
      refuse("policy.steps[", index, "].values: ", step.values[i], " for '", policy.names[i], "' is not in [",
             range.min, ", ", range.max, "]");
    }
  }
}

}  // namespace

void validate(const Policy& policy, const CommandLimitsByName& limits) {
  validate_names(policy.names, limits);
  if (policy.steps.empty()) refuse("policy.steps: empty; give at least one step");
  for (size_t i = 0; i < policy.steps.size(); ++i) validate_step(policy, i, limits);
}

PolicyPlayer::PolicyPlayer(Policy policy, std::vector<double> start_values) : policy_(std::move(policy)) {
  PolicyStep start;
  start.time_s = 0.0;
  start.values = std::move(start_values);
  policy_.steps.insert(policy_.steps.begin(), start);
}

std::vector<double> PolicyPlayer::values_at(double time_s) const {
  size_t next = 1;
  while (next < policy_.steps.size() && policy_.steps[next].time_s <= time_s) ++next;
  const PolicyStep& before = policy_.steps[next - 1];
  if (next == policy_.steps.size()) return before.values;
  const PolicyStep& after = policy_.steps[next];
  const double share = (time_s - before.time_s) / (after.time_s - before.time_s);
  std::vector<double> values(before.values.size());
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = before.values[i] + share * (after.values[i] - before.values[i]);
  return values;
}

}  // namespace soft_robot_lab
