// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/robot/scene/scene.h"

#include "cable_warnings.h"
#include "fidelity.h"
#include "locking.h"
#include "parameters.h"
#include "plausible_sizes.h"
#include "reduction.h"
#include "still_parts.h"
#include "robot/design/casting_settings.h"

namespace soft_robot_lab {

YamlNode with_overrides(const YamlNode& scene, const Overrides& overrides) {
  const YamlNode settings = with_includes(scene);
  return overrides.empty() ? settings : overrides.over(settings);
}

Scene build_scene(const YamlNode& settings, TetMesh mesh, const SceneOptions& options) {
  const SolverOptions solver = read_solver(settings);
  Body body = read_body(settings, std::move(mesh));
  read_contact(settings, mesher_options(options), body);
  const MeshLocator locator(body.mesh());
  auto actuators = read_actuators(settings, body, locator, options.actuator_factory);
  auto markers = read_markers(settings, body, locator);

  Scene scene;
  scene.warnings = implausible_sizes(settings, body, locator, markers);
  for (const auto& more :
       {still_parts(body, locator, markers), cable_warnings(settings, body, locator), locking_warnings(body)})
    scene.warnings.insert(scene.warnings.end(), more.begin(), more.end());
  scene.simulation = in_section(settings, [&] {
    return std::make_unique<Simulation>(std::move(body), std::move(actuators), std::move(markers), solver);
  });
  if (options.interrupt) scene.simulation->set_interrupt(options.interrupt);
  scene.run = read_run(settings, *scene.simulation);
  refuse_unbearable(settings, *scene.simulation, scene.run);
  return scene;
}

void read_for_others(const YamlNode& scene) {
  read_casting_settings(scene);
  read_parameters(scene);
}

Scene load_scene(const std::string& path, const SceneOptions& options) {
  return load_scene(YamlNode::load_file(path), options);
}

Scene load_scene(const YamlNode& node, const SceneOptions& options) {
  const YamlNode stated = with_method(with_overrides(node, options.overrides), options.method);
  read_for_others(stated);  // a wrong key there is said before anything is meshed
  refuse_megapascals(stated);
  refuse_unknown_reduced(stated, options);
  std::optional<FidelityReport> fidelity = settle_fidelity(stated, options);
  const bool chosen = fidelity && fidelity->choice;
  const YamlNode settings = chosen ? overrides_of(*fidelity->choice).over(stated) : stated;
  Scene scene = build_scene(settings, read_mesh(settings, options), options);
  read_for_others(settings);
  const std::optional<ReducedRequest> request = read_reduced(settings, scene, options.reduced);
  settings.require_all_read();
  if (request && options.on_warnings) options.on_warnings(scene.warnings);
  if (request) scene.reduction = reduce(settings, scene, *request, options);
  scene.untrained = request && !scene.reduction;
  scene.file = node.source();
  scene.fidelity = std::move(fidelity);
  return scene;
}

}  // namespace soft_robot_lab
