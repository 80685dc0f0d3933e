// SPDX-License-Identifier: BSD-3-Clause
#include <limits>

#include "sections.h"

namespace soft_robot_lab {

SolverOptions read_solver(const YamlNode& scene) {
  SolverOptions options;
  const std::optional<YamlNode> node = scene.optional_child("solver");
  if (!node) return options;
  // A reduced model is trained by newton, which goes on where it ends.
  if (node->choice_or("method", "newton", {"newton", "xpbd", "reduced"}) == "xpbd")
    options.method = SolverOptions::Method::xpbd;
  if (node->choice_or("integrator", "implicit_euler", {"implicit_euler", "bdf2"}) == "bdf2") {
    options.integrator = Integrator::bdf2;
  }
  options.time_step_s = node->number_or("time_step_s", options.time_step_s);
  options.tolerance = node->number_or("tolerance", options.tolerance);
  options.dynamic_tolerance = node->number_or("dynamic_tolerance", options.dynamic_tolerance);
  constexpr int kLeast = std::numeric_limits<int>::min(), kMost = std::numeric_limits<int>::max();
  options.max_iterations = node->integer_or("max_iterations", options.max_iterations, kLeast, kMost);
  if (options.method == SolverOptions::Method::xpbd) {
    options.substep_count = node->integer_or("substeps", options.substep_count, kLeast, kMost);
    options.iteration_count = node->integer_or("iterations", options.iteration_count, kLeast, kMost);
  }
  in_section(*node, [&] { options.validate(); });
  return options;
}

}  // namespace soft_robot_lab
