// SPDX-License-Identifier: BSD-3-Clause
// Robots of record with commands, gravity and obstacles drawn at random.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drawn_scenes.h"
#include "study/experiment.h"

namespace soft_robot_lab {

// One of the robots' files, below config/, with commands all over its range, up to two obstacles beside its skin that
// stand or are pushed into it, with or without friction, and gravity as it has it or along any direction. Loads its
// mesh; throws SettingsError as load_scene does. The same seed draws the same scene.
DrawnScene draw_robot_scene(std::uint64_t seed, double motion_s, const std::vector<std::string>& robots,
                            const ExperimentContext& context);

}  // namespace soft_robot_lab
