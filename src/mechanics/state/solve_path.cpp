// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/solve_report.h"

#include <algorithm>
#include <cmath>

namespace soft_robot_lab {

const char* name_of(SolveStage stage) {
  switch (stage) {
    case SolveStage::newton:
      return "newton";
    case SolveStage::line_search:
      return "line_search";
    case SolveStage::convexify:
      return "convexify";
    case SolveStage::energy_descent:
      return "energy_descent";
    case SolveStage::halving:
      return "halving";
    case SolveStage::pseudo_transient:
      return "pseudo_transient";
    case SolveStage::untangle:
      return "untangle";
    case SolveStage::last_resort:
      return "last_resort";
    case SolveStage::xpbd:
      return "xpbd";
    case SolveStage::reduced:
      return "reduced";
    case SolveStage::more:
      break;
  }
  return "more";
}

bool may_follow(SolveStage before, SolveStage after) {
  if (after == SolveStage::more || before == SolveStage::more) return after == SolveStage::more;
  if (before == SolveStage::xpbd) return after == SolveStage::xpbd || after == SolveStage::pseudo_transient;
  if (after == SolveStage::xpbd) return before <= SolveStage::convexify;  // that it left a saddle by
  if (before == SolveStage::reduced) return after == SolveStage::newton;  // where it is left for good
  if (after == SolveStage::reduced) return false;
  switch (before) {
    case SolveStage::newton:  // its own rescues first, then those around it
      return true;
    case SolveStage::line_search:
      return after != SolveStage::line_search;
    case SolveStage::convexify:
      return after != SolveStage::line_search && after != SolveStage::convexify;
    case SolveStage::last_resort:  // the next step, or the other half
      return after == SolveStage::newton || after == SolveStage::untangle;
    default:  // a rescue makes a new start for Newton
      return after == SolveStage::newton;
  }
}

void enter(SolveStage stage, int count, std::vector<SolvePathStage>& path) {
  if (!path.empty() && path.back().stage == stage) {
    path.back().count += count;
  } else if (path.size() < kLongestPath) {
    path.push_back({stage, count});
  } else if (path.back().stage == SolveStage::more) {
    ++path.back().count;
  } else {
    path.push_back({SolveStage::more, 1});
  }
}

void add_warning(const SolveWarning& warning, std::vector<SolveWarning>& all) {
  const auto same = std::find_if(all.begin(), all.end(), [&](const SolveWarning& other) {
    return other.kind == warning.kind && other.actuator == warning.actuator;
  });
  if (same == all.end()) {
    all.push_back(warning);
  } else if (std::abs(warning.size) > std::abs(same->size)) {
    *same = warning;
  }
}

}  // namespace soft_robot_lab
