// SPDX-License-Identifier: BSD-3-Clause
// How control's parts refuse what they cannot use.
#pragma once

#include <sstream>
#include <stdexcept>

namespace soft_robot_lab {

template <typename... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream message;
  (message << ... << parts);
  throw std::invalid_argument(message.str());
}

}  // namespace soft_robot_lab
