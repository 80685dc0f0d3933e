// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <string>

namespace soft_robot_lab {

// Of the service's answer, and of the same fields where a target was let go.
template <typename Answer>
std::string found_text(const Answer& found) {
  std::ostringstream text;
  text.precision(3);
  text << 1e3 * found.summary.final_distance_m << " mm from the target after " << found.summary.iterations
       << " iterations. " << found.message;
  return text.str();
}

}  // namespace soft_robot_lab
