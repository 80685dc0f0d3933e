// SPDX-License-Identifier: BSD-3-Clause
#include "configuration_table.h"

#include <algorithm>

namespace soft_robot_lab {
namespace {

Configuration read_configuration(const YamlNode& node, const std::string& commands, const AllowedRange& range) {
  Configuration configuration{node.text("name"), {}};
  for (const YamlNode& value : node.sequence(commands)) configuration.commands.push_back(value.as_number(range));
  if (configuration.name.empty()) node.fail("name is empty");
  if (configuration.commands.empty()) node.fail(commands + " is empty");
  return configuration;
}

// The first one's, which is that of all.
std::string key_of_commands(const YamlNode& file) {
  const std::vector<YamlNode> configurations = file.sequence("configurations");
  if (configurations.empty()) file.fail("configurations is empty");
  for (const char* key : {"syringe_ml", "commands"})
    if (configurations.front().has(key)) return key;
  return "contractions";
}

}  // namespace

bool commands_syringes(const YamlNode& file) { return key_of_commands(file) == "syringe_ml"; }

std::vector<Configuration> read_configurations(const YamlNode& file) {
  const std::string commands = key_of_commands(file);
  const AllowedRange range = commands == "contractions" ? AllowedRange::positive() : AllowedRange::any();
  std::vector<Configuration> configurations;
  for (const YamlNode& node : file.sequence("configurations")) {
    Configuration next = read_configuration(node, commands, range);
    const auto same_name = [&](const Configuration& other) { return other.name == next.name; };
    if (std::any_of(configurations.begin(), configurations.end(), same_name))
      node.fail("'" + next.name + "' is the name of two configurations");
    if (!configurations.empty() && configurations.front().commands.size() != next.commands.size())
      node.fail(commands + " has " + std::to_string(next.commands.size()) + " numbers, the first configuration " +
                std::to_string(configurations.front().commands.size()));
    configurations.push_back(std::move(next));
  }
  return configurations;
}

}  // namespace soft_robot_lab
