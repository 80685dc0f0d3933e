// SPDX-License-Identifier: BSD-3-Clause
// One command message goes to a simulation and to a rig: both must take it for the same thing.
#pragma once

#include <string>

#include "hardware/motor/rig_settings.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// Throws std::invalid_argument, naming both files, where an actuator of the scene has no motor or channel, or one that
// takes its command in another unit or for another thing.
void require_same_commands(const Simulation& simulation, const std::string& scene_file, const RigSettings& rig,
                           const std::string& rig_file);

}  // namespace soft_robot_lab
