// SPDX-License-Identifier: BSD-3-Clause
// Files whose names come from users, from other files or from recordings: a pipe would block and a device never ends.
#pragma once

#include <cstdint>
#include <string>

#include "limits.h"

namespace soft_robot_lab {

// The whole content. Throws std::invalid_argument with the name where it is no regular file, is larger, or cannot be
// read.
std::string read_regular_file(const std::string& path, std::uintmax_t largest_bytes);

// For files that a library opens by name. Throws as above.
void require_regular_file(const std::string& path, std::uintmax_t largest_bytes);

constexpr std::uintmax_t kLargestSettings_bytes = limits::kSettings_bytes;
constexpr std::uintmax_t kLargestMesh_bytes = limits::kMesh_bytes;

}  // namespace soft_robot_lab
