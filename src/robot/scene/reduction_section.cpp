// SPDX-License-Identifier: BSD-3-Clause
#include "reduction.h"

namespace soft_robot_lab {
namespace {

bool asks_for_reduced(const YamlNode& scene) {
  const std::optional<YamlNode> solver = scene.optional_child("solver");
  return solver && solver->text_or("method", "newton") == "reduced";
}

CommandLimits read_range(const YamlNode& item, CommandLimits limits) {
  const Eigen::VectorXd range = item.as_numbers();
  if (range.size() != 2) item.fail("must be a list of two numbers, the least and the largest command");
  limits.min = range[0];
  limits.max = range[1];
  return limits;
}

// Of actuators that it does not name all that they can do.
CommandBox read_command_box(const YamlNode& solver, const Simulation& simulation) {
  CommandBox box;
  const std::optional<YamlNode> node = solver.optional_child("commands");
  for (const auto& actuator : simulation.actuators()) {
    const std::optional<YamlNode> item = node ? node->optional_child(actuator->name()) : std::nullopt;
    const CommandLimits range = item ? read_range(*item, actuator->limits()) : actuator->limits();
    box.min.push_back(range.min);
    box.max.push_back(range.max);
  }
  return box;
}

}  // namespace

void refuse_unknown_reduced(const YamlNode& scene, const SceneOptions& options) {
  if (!asks_for_reduced(scene) || options.reduced == ReducedUse::by_newton) return;
  const YamlNode method = scene.child("solver").child("method");
  if (options.reduced == ReducedUse::refused)
    method.fail(
        "reduced is for sessions and the programs simulate, rollouts and optimise; must be newton or xpbd here");
  if (scene.has("fidelity")) method.fail("reduced is not chosen by fidelity; leave out one of the two");
}

std::optional<ReducedRequest> read_reduced(const YamlNode& settings, const Scene& scene, ReducedUse use) {
  if (!asks_for_reduced(settings)) return std::nullopt;
  const YamlNode solver = settings.child("solver");
  ReducedRequest request;
  request.tolerance_m = solver.number_or("tolerance_m", request.tolerance_m, AllowedRange::positive());
  request.audit_every_s = solver.number_or("audit_every_s", request.audit_every_s, AllowedRange::positive());
  if (solver.has("modes")) request.modes = solver.integer("modes", 1, 40);
  request.box = read_command_box(solver, *scene.simulation);
  request.may_narrow = !solver.has("commands");
  if (use == ReducedUse::by_newton) return std::nullopt;
  if (use == ReducedUse::trained && scene.run.mode == RunMode::modal)
    settings.child("run").fail("mode modal is not for solver.method reduced; choose newton");
  return request;
}

std::shared_ptr<const SceneReduction> reduce(const YamlNode& settings, const Scene& scene,
                                             const ReducedRequest& request, const SceneOptions& options) {
  const std::shared_ptr<const Model>& model = scene.simulation->model();
  const std::string key = reduction_key(settings, model->body());
  if (std::optional<ReducedChoice> known = find_reduction(key, model, options))
    return std::make_shared<SceneReduction>(SceneReduction{std::move(*known), request, true});
  if (options.reduced == ReducedUse::if_kept) return nullptr;
  const TrainingProgress progress = [&](double share, const std::string& what) {
    refuse_interrupted(options);
    if (options.progress) options.progress(share, what);
  };
  SceneReduction made{in_section(settings.child("solver"), [&] { return choose_modes(model, request, progress); }),
                      request, false};
  keep_reduction(key, made.choice, options);
  return std::make_shared<SceneReduction>(std::move(made));
}

}  // namespace soft_robot_lab
