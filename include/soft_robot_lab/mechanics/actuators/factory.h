// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "soft_robot_lab/mechanics/actuator.h"

namespace soft_robot_lab {

// The actuators of this package by plugin name, for programs without a plugin loader. Throws std::invalid_argument
// listing the known names.
std::unique_ptr<Actuator> make_actuator(const std::string& plugin);

}  // namespace soft_robot_lab
