// SPDX-License-Identifier: BSD-3-Clause
#include "poses.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace soft_robot_lab {
namespace {

// Without what separates the parts of a line.
std::string plain(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ':' || c == '\n' || c == '='; }, ' ');
  return name;
}

std::map<std::string, double> values_of(const std::string& text) {
  std::map<std::string, double> values;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    std::istringstream number(equals == std::string::npos ? "" : word.substr(equals + 1));
    double value = 0.0;
    if (number >> value && std::isfinite(value)) values[word.substr(0, equals)] = value;
  }
  return values;
}

}  // namespace

std::string Poses::store(const std::string& name, const std::vector<ActuatorRow>& rows) {
  std::string key = plain(name);
  for (int number = 1; key.empty(); ++number)
    if (const std::string free = "pose " + std::to_string(number); poses_.count(free) == 0) key = free;
  poses_[key].clear();
  for (const ActuatorRow& row : rows) poses_[key][row.name] = row.shown;
  return key;
}

std::vector<std::string> Poses::names() const {
  std::vector<std::string> names;
  for (const auto& [name, values] : poses_) names.push_back(name);
  return names;
}

Policy Poses::policy(const std::string& name, const std::vector<ActuatorRow>& rows, double duration_s) const {
  Policy policy;
  policy.steps.emplace_back();
  policy.steps.back().time_s = duration_s;
  const auto pose = poses_.find(name);
  for (const ActuatorRow& row : rows) {
    if (pose == poses_.end() || pose->second.count(row.name) == 0) continue;
    policy.names.push_back(row.name);
    policy.steps.back().values.push_back(std::clamp(pose->second.at(row.name), row.min, row.max));
  }
  if (policy.names.empty())
    throw std::invalid_argument("pose '" + name + "' has no command for any actuator of this robot");
  return policy;
}

std::string Poses::text() const {
  std::ostringstream text;
  text.precision(17);
  for (const auto& [name, values] : poses_) {
    text << name << ":";
    for (const auto& [actuator, value] : values) text << " " << actuator << "=" << value;
    text << "\n";
  }
  return text.str();
}

void Poses::read(const std::string& text) {
  poses_.clear();
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos || colon == 0) continue;
    if (auto values = values_of(line.substr(colon + 1)); !values.empty()) poses_[line.substr(0, colon)] = values;
  }
}

}  // namespace soft_robot_lab
