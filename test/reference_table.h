// SPDX-License-Identifier: BSD-3-Clause
// The reference solutions of the package, for tests.
#pragma once

#include <string>
#include <vector>

#include "settings/reference_table.h"

namespace soft_robot_lab {

inline std::vector<ReferenceRow> read_reference(const std::string& name) {
  return read_reference(std::string(SOFT_ROBOT_LAB_SOURCE) + "/config/reference", name);
}

}  // namespace soft_robot_lab
