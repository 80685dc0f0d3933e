// SPDX-License-Identifier: BSD-3-Clause
#include <limits>

#include "sections.h"

namespace soft_robot_lab {

namespace {

// A body whose damping is given must not be damped by the integrator too. One that only creeps would swing for ever.
std::string default_integrator(const YamlNode& scene, const std::string& method) {
  const std::optional<YamlNode> body = scene.optional_child("body");
  return body && body->has("damping") && method == "newton" ? "tr_bdf2" : "implicit_euler";
}

Integrator integrator_named(const std::string& name) {
  if (name == "bdf2") return Integrator::bdf2;
  return name == "tr_bdf2" ? Integrator::tr_bdf2 : Integrator::implicit_euler;
}

}  // namespace

YamlNode with_method(const YamlNode& stated, const std::string& method) {
  if (method.empty()) return stated;
  Overrides own;
  own.set({"solver", "method"}, method);
  if (method != "newton") own.set({"solver", "integrator"}, "implicit_euler");
  const YamlNode settings = own.over(stated);
  const YamlNode solver = settings.child("solver");
  for (const char* key : {"substeps", "iterations", "tolerance_m", "audit_every_s", "modes"})
    solver.optional_child(key);
  if (solver.has("commands") && method != "reduced") Overrides ranges(solver.child("commands"));  // counts as read
  return settings;
}

SolverOptions read_solver(const YamlNode& scene) {
  SolverOptions options;
  const std::optional<YamlNode> node = scene.optional_child("solver");
  if (!node) {
    options.integrator = integrator_named(default_integrator(scene, "newton"));
    return options;
  }
  // A reduced model is trained by newton, which goes on where it ends.
  const std::string method = node->choice_or("method", "newton", {"newton", "xpbd", "reduced"});
  if (method == "xpbd") options.method = SolverOptions::Method::xpbd;
  options.integrator = integrator_named(
      node->choice_or("integrator", default_integrator(scene, method), {"implicit_euler", "bdf2", "tr_bdf2"}));
  options.time_step_s = node->number_or("time_step_s", options.time_step_s);
  options.tolerance = node->number_or("tolerance", options.tolerance);
  options.dynamic_tolerance = node->number_or("dynamic_tolerance", options.dynamic_tolerance);
  options.time_limit_s = node->number_or("time_limit_s", options.time_limit_s);
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
