// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/policy.h"

#include <cmath>
#include <iomanip>
#include <set>
#include <sstream>
#include <utility>

#include "mechanics/simulation/limit_hint.h"
#include "refuse.h"
#include "settings/limits.h"
#include "settings/words.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

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

void validate_step(const CommandPolicy& policy, size_t index, const CommandLimitsByName& limits) {
  const TimedCommandValues& step = policy.steps[index];
  const double earliest_s = index == 0 ? 0.0 : policy.steps[index - 1].time_s;
  if (!(step.time_s >= earliest_s && step.time_s <= limits::kTime_s)) {
    refuse("policy.steps[", index, "].time_s: ", step.time_s, " is not in [", earliest_s, ", ", limits::kTime_s, "]");
  }
  if (step.values.size() != policy.names.size()) {
    refuse("policy.steps[", index, "].values: ", step.values.size(), " values for ", policy.names.size(), " names");
  }
  for (size_t i = 0; i < step.values.size(); ++i) {
    const CommandRange& range = limits.at(policy.names[i]);
    if (!(step.values[i] >= range.min && step.values[i] <= range.max)) {
      refuse("policy.steps[", index, "].values: ", step.values[i], " for '", policy.names[i], "' is not in [",
             range.min, ", ", range.max, "]", step.values[i] < range.min ? range.min_hint : range.max_hint);
    }
  }
}

}  // namespace

CommandLimitsByName limits_of(const Simulation& simulation) {
  CommandLimitsByName limits;
  for (int i = 0; i < static_cast<int>(simulation.actuators().size()); ++i) {
    const Actuator& actuator = *simulation.actuators()[static_cast<size_t>(i)];
    limits[actuator.name()] = {actuator.limits(), limit_hint(simulation, i, true), limit_hint(simulation, i, false)};
  }
  return limits;
}

void validate(const CommandPolicy& policy, const CommandLimitsByName& limits) {
  validate_names(policy.names, limits);
  if (policy.steps.empty()) refuse("policy.steps: empty; give at least one step");
  for (size_t i = 0; i < policy.steps.size(); ++i) validate_step(policy, i, limits);
}

void require_robot(const CommandPolicy& policy, const std::string& robot) {
  if (policy.robot.empty() || policy.robot == robot) return;
  refuse("policy.robot: this policy is for '", policy.robot, "', and '", robot,
         "' runs; leave `robot` out to play it all the same");
}

CommandPolicy load_policy(const std::string& path) {
  const YamlNode file = YamlNode::load_file(path);
  CommandPolicy policy;
  for (const YamlNode& name : file.sequence("names")) policy.names.push_back(name.as_text());
  for (const YamlNode& step : file.sequence("steps")) {
    TimedCommandValues values;
    values.time_s = step.number("time_s", AllowedRange::not_negative());
    for (const YamlNode& value : step.sequence("values")) values.values.push_back(value.as_number());
    policy.steps.push_back(std::move(values));
  }
  if (file.has("robot")) policy.robot = file.text("robot");
  file.require_all_read();
  return policy;
}

std::string policy_yaml(const CommandPolicy& policy) {
  std::ostringstream out;
  out << std::setprecision(17);
  if (!policy.robot.empty()) out << "robot: " << quote(policy.robot) << "\n";
  out << "names: [";
  for (size_t i = 0; i < policy.names.size(); ++i) out << (i ? ", " : "") << quote(policy.names[i]);
  out << "]\nsteps:\n";
  for (const TimedCommandValues& step : policy.steps) {
    out << "  - {time_s: " << step.time_s << ", values: [";
    for (size_t i = 0; i < step.values.size(); ++i) out << (i ? ", " : "") << step.values[i];
    out << "]}\n";
  }
  return out.str();
}

PolicyPlayer::PolicyPlayer(CommandPolicy policy, std::vector<double> start_values) : policy_(std::move(policy)) {
  policy_.steps.insert(policy_.steps.begin(), {0.0, std::move(start_values)});
}

std::vector<double> PolicyPlayer::values_at(double time_s) const {
  size_t next = 1;
  while (next < policy_.steps.size() && policy_.steps[next].time_s <= time_s) ++next;
  const TimedCommandValues& before = policy_.steps[next - 1];
  if (next == policy_.steps.size()) return before.values;
  const TimedCommandValues& after = policy_.steps[next];
  const double fraction = (time_s - before.time_s) / (after.time_s - before.time_s);
  std::vector<double> values(before.values.size());
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = before.values[i] + fraction * (after.values[i] - before.values[i]);
  return values;
}

std::vector<Eigen::Matrix3Xd> replay(Simulation& simulation, const CommandPolicy& policy,
                                     const std::vector<std::string>& markers) {
  std::vector<Eigen::Matrix3Xd> places;
  for (const TimedCommandValues& step : policy.steps) {
    ForwardModel model(simulation, markers, policy.names);  // one a step: a step starts where the last one ended
    const Eigen::Map<const Eigen::VectorXd> values(step.values.data(), static_cast<Eigen::Index>(step.values.size()));
    places.push_back(model.predict(values, false).markers_m);
  }
  return places;
}

}  // namespace soft_robot_lab
