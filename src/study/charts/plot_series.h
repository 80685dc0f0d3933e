// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>

#include "session/report/plot.h"

namespace soft_robot_lab {

// The series of a plot that has this label; a new one at its end where none has.
inline Series& series_of(Plot& plot, const std::string& label) {
  const auto known =
      std::find_if(plot.series.begin(), plot.series.end(), [&](const Series& one) { return one.label == label; });
  if (known != plot.series.end()) return *known;
  plot.series.push_back({label, {}, {}});
  return plot.series.back();
}

}  // namespace soft_robot_lab
