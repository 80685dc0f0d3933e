// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz_scene.h"

#include <stdexcept>
#include <string>

#include "fuzz_rules.h"
#include "robot/scene/fidelity.h"
#include "mechanics/box_mesh.h"
#include "soft_robot_lab/mechanics/actuators/factory.h"
#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {
namespace {

// As long as most robots, with a hollow in its middle.
TetMesh hollow_bar() {
  const Eigen::Vector3d min_m(-0.01, -0.01, -0.1), max_m(0.01, 0.01, 0);
  const TetMesh whole = box_mesh(min_m, max_m, {3, 3, 3}, false);
  constexpr int middle = 13 * 6, cell = 6;  // of 27 cells of six tetrahedra
  TetMesh mesh = whole;
  mesh.tets.resize(4, whole.tet_count() - cell);
  mesh.tets << whole.tets.leftCols(middle), whole.tets.rightCols(whole.tet_count() - middle - cell);
  complete_boundary(mesh);
  mesh.surface_names = {"cavity"};
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    Eigen::Vector3d middle_m = Eigen::Vector3d::Zero();
    for (int corner = 0; corner < 3; ++corner) middle_m += mesh.nodes_m.col(mesh.faces(corner, face)) / 3;
    const bool outside = ((middle_m - min_m).array() < 1e-9).any() || ((max_m - middle_m).array() < 1e-9).any();
    mesh.face_surface[static_cast<std::size_t>(face)] = outside ? -1 : 0;
  }
  return make_quadratic(mesh);
}

void load(const std::string& text) {
  const YamlNode settings = with_includes(YamlNode::parse(text, "fuzz.yaml"));
  const YamlNode body = settings.child("body");
  if (body.has("solid")) require_rule(!to_yaml(read_solid(body.child("solid"))).empty());
  for (const char* key : {"mesh", "element", "element_size_m", "refinements"})
    if (body.has(key)) body.child(key).dump();  // of the mesh, which is another here
  if (!body.has("element")) read_fidelity(settings);
  static const TetMesh mesh = hollow_bar();
  SceneOptions options;
  options.actuator_factory = make_actuator;
  const Scene scene = build_scene(settings, mesh, options);
  require_rule(scene.simulation->state().positions_m.allFinite());
  for (const Marker& marker : scene.simulation->markers())
    require_rule(marker.position(scene.simulation->state().positions_m).allFinite());
  for (const TimedCommands& at : scene.run.commands) require_rule(at.time_s >= 0 && at.time_s < 1e300);
  settings.require_all_read();
}

}  // namespace

// What is wrong with a scene is said by std::invalid_argument, of which SettingsError is one, and by nothing else.
void fuzz_scene(const std::uint8_t* data, std::size_t size) {
  try {
    load({reinterpret_cast<const char*>(data), size});
  } catch (const std::invalid_argument& error) {
    require_rule(*error.what() != '\0');
  }
}

}  // namespace soft_robot_lab
