// SPDX-License-Identifier: BSD-3-Clause
#include "descent.h"
#include "mechanics/solver_constants.h"

#include <algorithm>
#include <cmath>

namespace soft_robot_lab {
namespace {

NewtonTask rest_task(const SimulationParts& parts) {
  NewtonTask task;
  task.tolerance = parts.options.tolerance;
  task.max_iterations = std::min(parts.options.max_iterations, constants::kStageIterations);
  return task;
}

NewtonReport fall_for(double h, SimulationParts& parts, NewtonState& unknown, SolveReport& report) {
  NewtonTask task = rest_task(parts);
  task.tolerance = std::max(task.tolerance, 1e-4);
  task.min_iterations = 1;
  task.inertia_per_s2 = 1.0 / (h * h);
  const Eigen::Matrix3Xd start = parts.state.positions_m;
  task.predicted_m = &start;
  const NewtonReport newton = parts.solve(task, unknown, report);
  return newton.converged ? newton : parts.solve_from_below(task, unknown, report);
}

}  // namespace

bool within_budget(const SimulationParts& parts, const SolveReport& report) {
  return report.iterations < constants::kEquilibriumBudget * parts.options.max_iterations;
}

bool relax(SimulationParts& parts, SolveReport& report, const EquilibriumOptions& options) {
  NewtonState unknown = parts.unknowns();
  NewtonTask task = rest_task(parts);
  task.tolerance = std::max(task.tolerance, options.tolerance);
  task.only_through_stable = options.only_through_stable;
  if (!parts.solve(task, unknown, report).converged) return false;
  parts.accept(std::move(unknown));
  return true;
}

bool relax_from_below(SimulationParts& parts, SolveReport& report) {
  NewtonState unknown = parts.unknowns();
  if (!parts.solve_from_below(rest_task(parts), unknown, report).converged) return false;
  parts.accept(std::move(unknown));
  return true;
}

bool descend(SimulationParts& parts, SolveReport& report) {
  const Material& material = parts.body.material();
  const double wave_s = parts.body.size_m() * std::sqrt(material.density_kg_m3 / material.youngs_modulus_pa);
  const int limit = report.iterations + constants::kTransientBudget * parts.options.max_iterations;
  double h = 3.0 * wave_s;
  while (report.iterations < limit && h > 1e-3 * wave_s) {
    enter(SolveStage::pseudo_transient, 1, report.path);
    NewtonState unknown = parts.unknowns();
    const NewtonReport newton = fall_for(h, parts, unknown, report);
    if (!newton.converged) {
      h *= 0.25;
      continue;
    }
    parts.accept(std::move(unknown));
    if (h > 1e3 * wave_s && relax(parts, report)) return true;
    h *= newton.iterations <= 5 ? 3.0 : 1.5;
  }
  return false;
}

}  // namespace soft_robot_lab
