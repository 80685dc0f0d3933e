// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "soft_robot_lab/robot/design/mesher.h"
#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

// The path of what mesh_robot makes of a request's text, now or found in the cache by the text and the content of the
// files that it names. Throws as mesh_file_for does.
std::string run_mesher(const std::string& text, const std::vector<std::string>& files, const std::string& ending,
                       const MesherOptions& options);

// All that a solid is read from, in its order.
std::vector<std::string> referenced_files(const Solid& solid);

}  // namespace soft_robot_lab
