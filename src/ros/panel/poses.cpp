// SPDX-License-Identifier: BSD-3-Clause
#include "poses.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include "settings/read_file.h"
#include "settings/words.h"
#include "settings/write_file.h"
#include "soft_robot_lab/robot/scene/scene_file.h"

namespace soft_robot_lab {
namespace {

// Without what separates the parts of a line.
std::string plain(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == ':' || c == '\n' || c == '='; }, ' ');
  return name;
}

// A path or a name as one word without what separates others.
std::string encoded(const std::string& path) {
  static const char* digits = "0123456789abcdef";
  std::string word;
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte > ' ' && byte != 0x7f && c != '%' && c != '|' && c != '=' && c != '@') {
      word += c;
    } else {
      word += {'%', digits[byte / 16], digits[byte % 16]};
    }
  }
  return word;
}

std::string decoded(const std::string& word) {
  std::string path;
  for (std::size_t i = 0; i < word.size(); ++i) {
    const bool code = word[i] == '%' && i + 2 < word.size() && std::isxdigit(static_cast<unsigned char>(word[i + 1])) &&
                      std::isxdigit(static_cast<unsigned char>(word[i + 2]));
    path += code ? static_cast<char>(std::strtol(word.substr(i + 1, 2).c_str(), nullptr, 16)) : word[i];
    if (code) i += 2;
  }
  return path;
}

std::string robot_of(const std::string& text) {
  std::istringstream words(text);
  for (std::string word; words >> word;)
    if (word.rfind("@=", 0) == 0) return decoded(word.substr(2));
  return "";
}

std::map<std::string, double> values_of(const std::string& text) {
  std::map<std::string, double> values;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0 || word[0] == '@') continue;
    const std::optional<double> value = parse_number<double>(word.substr(equals + 1));
    if (value && std::isfinite(*value)) values[decoded(word.substr(0, equals))] = *value;
  }
  return values;
}

}  // namespace

void Poses::set_scene(const std::string& path) {
  robot_ = path.empty() ? "" : robot_file(path);
  robot_name_ = path.empty() ? "" : name_of_robot(path);
}

std::string Poses::store(const std::string& name, const std::vector<ActuatorRow>& rows) {
  std::string key = plain(name);
  for (int number = 1; key.empty(); ++number)
    if (const std::string free = "pose " + std::to_string(number); !find(free)) key = free;
  remove(key);
  Values& values = poses_[{robot_, key}];
  for (const ActuatorRow& row : rows) values[row.name] = row.command();
  return key;
}

void Poses::remove(const std::string& name) {
  poses_.erase({robot_, name});
  poses_.erase({"", name});
}

const Poses::Values* Poses::find(const std::string& name) const {
  for (const std::string& robot : {robot_, std::string()})
    if (const auto found = poses_.find({robot, name}); found != poses_.end()) return &found->second;
  return nullptr;
}

std::vector<std::string> Poses::names() const {
  std::set<std::string> names;
  for (const auto& [of, values] : poses_)
    if (of.first.empty() || of.first == robot_) names.insert(of.second);
  return {names.begin(), names.end()};
}

Policy Poses::policy(const std::string& name, const std::vector<ActuatorRow>& rows, double duration_s) const {
  Policy policy;
  policy.steps.emplace_back();
  policy.steps.back().time_s = duration_s;
  policy.robot = robot_name_;
  const Values* pose = find(name);
  for (const ActuatorRow& row : rows) {
    if (!pose || pose->count(row.name) == 0) continue;
    policy.names.push_back(row.name);
    policy.steps.back().values.push_back(
        std::clamp(pose->at(row.name), row.command_per_unit * row.min, row.command_per_unit * row.max));
  }
  if (policy.names.empty())
    throw std::invalid_argument("pose '" + name + "' has no command for any actuator of this robot");
  return policy;
}

std::string Poses::text() const {
  std::ostringstream text;
  text.precision(17);
  for (const auto& [of, values] : poses_) {
    text << of.second << ":";
    if (!of.first.empty()) text << " @=" << encoded(of.first);
    for (const auto& [actuator, value] : values) text << " " << encoded(actuator) << "=" << value;
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
    const std::string rest = line.substr(colon + 1);
    if (auto values = values_of(rest); !values.empty()) poses_[{robot_of(rest), line.substr(0, colon)}] = values;
  }
}

void Poses::read_file(const std::string& file) {
  read(std::filesystem::exists(file) ? read_regular_file(file, kLargestSettings_bytes) : "");
}

void Poses::write_file(const std::string& file) const {
  std::filesystem::create_directories(std::filesystem::path(file).parent_path());
  soft_robot_lab::write_file(file, text());
}

}  // namespace soft_robot_lab
