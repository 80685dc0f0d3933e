// SPDX-License-Identifier: BSD-3-Clause
// Options of the package's programs that name a file or folder to be written.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace soft_robot_lab {

inline const std::vector<std::string>& written_options() {
  static const std::vector<std::string> names = {"--output", "--result", "--policy", "--page"};
  return names;
}

inline bool is_written_option(const std::string& name) {
  return std::find(written_options().begin(), written_options().end(), name) != written_options().end();
}

}  // namespace soft_robot_lab
