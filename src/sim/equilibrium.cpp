#include "equilibrium.h"

#include <algorithm>
#include <sstream>

#include "descent.h"

namespace soft_robot_lab {
namespace {

constexpr double kSmallestStage = 64;  // a command change is cut into at most this many continuation stages

void tell_unfinished(double done, SolveReport& report) {
  report.converged = false;
  std::ostringstream reached;
  reached << "no equilibrium found beyond " << 100.0 * done << " % of the command change, in " << report.iterations
          << " iterations: " << (report.message.empty() ? "work limit" : report.message);
  report.message = reached.str();
}

}  // namespace

void find_equilibrium(SimulationParts& parts, SolveReport& report) {
  const std::vector<double> from = parts.state.actuated_commands;
  double done = 0.0, stage = 1.0;
  while (done < 1.0 && within_budget(parts, report)) {
    const double share = std::min(1.0, done + stage);
    parts.move_actuators(from, share);
    bool found = relax(parts, report);
    if (!found && stage * kSmallestStage <= 1.0) {
      found = descend(parts, report);
      if (!found) break;
    }
    if (found) done = share;
    stage *= found ? 2.0 : 0.5;
  }
  if (done == 1.0) return;
  parts.move_actuators(from, 1.0);
  tell_unfinished(done, report);
}

}  // namespace soft_robot_lab
