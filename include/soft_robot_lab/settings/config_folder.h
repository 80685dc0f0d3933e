// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace soft_robot_lab {

// The package's config/: beside an installed program in share/, otherwise in the sources this was built from.
std::string config_folder();

}  // namespace soft_robot_lab
