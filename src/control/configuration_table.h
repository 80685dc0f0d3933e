// SPDX-License-Identifier: BSD-3-Clause
// A table of configurations as the source has them: each is commanded after the one before, in the table's order.
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {

struct Configuration {
  std::string name;              // the source's letter
  std::vector<double> commands;  // one for each actuator of the robot, in its order
};

// configurations: [{name: a, contractions: [1, 1]}, {name: b, contractions: [1, 0.8]}, ...]
// or with syringe_ml: [0, 0, 20], the plungers' travel, or with commands: [0, 20000], of any actuators in the units of
// their commands. Names differ, and all have equally many commands, at least one.
// Throws SettingsError.
std::vector<Configuration> read_configurations(const YamlNode& file);

// Whether its commands are a syringe's ml. Throws SettingsError where there is no configuration.
bool commands_syringes(const YamlNode& file);

}  // namespace soft_robot_lab
