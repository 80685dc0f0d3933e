// SPDX-License-Identifier: BSD-3-Clause
#include "running_scene.h"

#include <set>

#include <ros/console.h>

#include "ros/base/log_text.h"

namespace soft_robot_lab {

RunningScene::RunningScene(Scene loaded, double skin_opacity)
    : path(loaded.file),
      warnings(std::move(loaded.warnings)),
      fidelity(std::move(loaded.fidelity)),
      untrained(loaded.untrained),
      simulation(std::move(loaded.simulation)),
      motion(*simulation, std::move(loaded.reduction)),
      surface(simulation->body().mesh(), skin_opacity > 0.0 ? skin_opacity : fitting_opacity(*simulation)) {}

std::string RunningScene::solver() const {
  if (untrained || motion.reduction()) return "reduced";
  return simulation->options().method == SolverOptions::Method::xpbd ? "xpbd" : "newton";
}

std::unique_ptr<RunningScene> load_running_scene(const std::string& path, SceneOptions options, double skin_opacity) {
  std::set<std::string> said;
  options.on_warnings = [&](const std::vector<SolveWarning>& warnings) {
    for (const SolveWarning& warning : warnings)
      if (said.insert(warning.text).second) ROS_WARN("%s: %s", path.c_str(), log_text(warning.text).c_str());
  };
  auto scene = std::make_unique<RunningScene>(load_scene(path, options), skin_opacity);
  const TetMesh& mesh = scene->simulation->body().mesh();
  ROS_INFO("%s: %d elements, %d nodes", path.c_str(), mesh.tet_count(), mesh.node_count());
  options.on_warnings(scene->warnings);
  if (scene->fidelity) {
    ROS_INFO("%s: %s", path.c_str(), summary(*scene->fidelity).c_str());
    if (!scene->fidelity->met)
      ROS_WARN("%s: expected error of the markers: %s", path.c_str(), expected_error_text(*scene->fidelity).c_str());
  }
  return scene;
}

}  // namespace soft_robot_lab
