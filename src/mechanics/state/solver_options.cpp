// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/solver_options.h"

#include <stdexcept>

#include "settings/require.h"

namespace soft_robot_lab {

void SolverOptions::validate() const {
  require(time_step_s > 0.0 && time_step_s <= 1.0, "solver.time_step_s", time_step_s, "(0, 1]");
  require(tolerance > 0.0 && tolerance < 1.0, "solver.tolerance", tolerance, "(0, 1)");
  require(dynamic_tolerance > 0.0 && dynamic_tolerance < 1.0, "solver.dynamic_tolerance", dynamic_tolerance, "(0, 1)");
  require(time_limit_s > 0.0, "solver.time_limit_s", time_limit_s, "> 0");
  require(max_iterations >= 1 && max_iterations <= 10000, "solver.max_iterations", max_iterations, "[1, 10000]");
  require(substep_count >= 1 && substep_count <= 10000, "solver.substeps", substep_count, "[1, 10000]");
  require(iteration_count >= 1 && iteration_count <= 10000, "solver.iterations", iteration_count, "[1, 10000]");
  if (method == Method::xpbd && integrator != Integrator::implicit_euler)
    throw std::invalid_argument(
        "solver.integrator: must be implicit_euler with solver.method xpbd, not bdf2 or tr_bdf2");
}

}  // namespace soft_robot_lab
