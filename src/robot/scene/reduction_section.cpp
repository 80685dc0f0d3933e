// SPDX-License-Identifier: BSD-3-Clause
#include "reduction.h"

namespace soft_robot_lab {
namespace {

bool asks_for_reduced(const YamlNode& scene) {
  const std::optional<YamlNode> solver = scene.optional_child("solver");
  return solver && solver->text_or("method", "newton") == "reduced";
}

// A range of each actuator, and of nothing else.
CommandBox read_command_box(const YamlNode& solver, const Simulation& simulation) {
  CommandBox box;
  const YamlNode node = solver.child("commands");
  for (const auto& actuator : simulation.actuators()) {
    const YamlNode item = node.child(actuator->name());
    const Eigen::VectorXd range = item.as_numbers();
    if (range.size() != 2) item.fail("must be a list of two numbers, the least and the largest command");
    box.min.push_back(range[0]);
    box.max.push_back(range[1]);
  }
  return box;
}

void refuse_other_questions(const YamlNode& settings, const RunSettings& run) {
  if (run.mode == RunMode::modal)
    settings.child("run").fail("mode modal is not for solver.method reduced; choose newton");
  if (run.sensitivity) settings.child("run").fail("sensitivity is not for solver.method reduced; choose newton");
}

}  // namespace

void refuse_unknown_reduced(const YamlNode& scene, const SceneOptions& options) {
  if (!asks_for_reduced(scene)) return;
  const YamlNode method = scene.child("solver").child("method");
  if (!options.knows_reduced)
    method.fail("reduced is for the programs simulate, rollouts and optimise; must be newton or xpbd here");
  if (scene.has("fidelity")) method.fail("reduced is not chosen by fidelity; leave out one of the two");
}

std::optional<ReducedRequest> read_reduced(const YamlNode& settings, const Scene& scene) {
  if (!asks_for_reduced(settings)) return std::nullopt;
  const YamlNode solver = settings.child("solver");
  refuse_other_questions(settings, scene.run);
  ReducedRequest request;
  request.tolerance_m = solver.number_or("tolerance_m", request.tolerance_m, AllowedRange::positive());
  request.audit_every_s = solver.number_or("audit_every_s", request.audit_every_s, AllowedRange::positive());
  if (solver.has("modes")) request.modes = solver.integer("modes", 1, 40);
  request.box = read_command_box(solver, *scene.simulation);
  return request;
}

std::shared_ptr<const SceneReduction> reduce(const YamlNode& settings, const Scene& scene,
                                             const ReducedRequest& request, const SceneOptions& options) {
  const std::shared_ptr<const Model>& model = scene.simulation->model();
  const std::string key = reduction_key(settings, model->body());
  if (std::optional<ReducedChoice> known = find_reduction(key, model, request, options))
    return std::make_shared<SceneReduction>(SceneReduction{std::move(*known), request, true});
  SceneReduction made{
      in_section(settings.child("solver"), [&] { return choose_modes(model, request, options.progress); }), request,
      false};
  keep_reduction(key, made.choice, options);
  return std::make_shared<SceneReduction>(std::move(made));
}

}  // namespace soft_robot_lab
