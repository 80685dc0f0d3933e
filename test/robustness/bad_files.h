// SPDX-License-Identifier: BSD-3-Clause
// Scenes whose files, names or sizes are bad: scripts in place of meshes, damaged meshes and archives, names that a
// shell, a page or a path would take for more, and counts that ask for more memory than there is.
#pragma once

#include <vector>

#include "bad_scenes.h"

namespace soft_robot_lab {

// What a script among the files would write, were it run, beside its scene.
inline constexpr const char* kTrace = "it_was_run";

// The same seed makes the same; another one draws other scripts, damages, names and counts.
std::vector<BadScene> bad_files(unsigned int seed);

}  // namespace soft_robot_lab
