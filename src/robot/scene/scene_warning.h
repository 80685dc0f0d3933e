// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

// Of what is odd about a scene before it runs.
inline SolveWarning scene_warning(const std::string& kind, const std::string& text, double size = 0.0,
                                  const std::string& unit = "1") {
  SolveWarning warning;
  warning.kind = kind;
  warning.size = size;
  warning.unit = unit;
  warning.text = text;
  return warning;
}

}  // namespace soft_robot_lab
