// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include <sys/types.h>

namespace soft_robot_lab {

// The process of a node that answers within `limit_s`: not one that was killed, which the master still knows, nor one
// that is stopped.
std::optional<pid_t> answering_process(const std::string& node, double limit_s);

}  // namespace soft_robot_lab
