// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace soft_robot_lab {

// The keys of shapes, in the order of Solid::Kind.
const std::vector<std::string>& solid_kind_names();

}  // namespace soft_robot_lab
