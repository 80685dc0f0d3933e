#include "soft_robot_lab/scene/scene.h"

#include "scene/sections.h"

namespace soft_robot_lab {
namespace {

SettingsNode read_settings(const std::string& path, const std::string& changes) {
  const SettingsNode settings = load_settings_with_includes(path);
  return changes.empty() ? settings : merge_settings(settings, SettingsNode::parse(changes, path + " (with changes)"));
}

}  // namespace

Scene load_scene(const std::string& path, const SceneOptions& options) {
  const SettingsNode settings = read_settings(path, options.changes);
  refuse_contact(settings);
  const SolverOptions solver = read_solver(settings);

  TetMesh mesh = read_mesh(settings, {options.mesher, options.cache_folder, options.meshing_limit_s});
  if (options.change_mesh) options.change_mesh(mesh);
  Body body = read_body(settings, std::move(mesh));
  const MeshLocator locator(body.mesh());
  auto actuators = read_actuators(settings, body, locator, options.actuator_factory);
  auto markers = read_markers(settings, body, locator);

  Scene scene;
  scene.file = path;
  scene.simulation = in_section(settings, [&] {
    return std::make_unique<Simulation>(std::move(body), std::move(actuators), std::move(markers), solver);
  });
  scene.run = read_run(settings, *scene.simulation);
  settings.require_all_read();
  return scene;
}

}  // namespace soft_robot_lab
