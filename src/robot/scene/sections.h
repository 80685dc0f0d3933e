// SPDX-License-Identifier: BSD-3-Clause
// The sections of a scene file, one reader each. All throw SettingsError with file, line and key.
#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "soft_robot_lab/robot/design/mesher.h"
#include "soft_robot_lab/robot/scene/scene.h"
#include "soft_robot_lab/settings/yaml_node.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

// The settings with the files they include merged below them.
YamlNode with_includes(const YamlNode& settings);

YamlNode with_overrides(const YamlNode& scene, const Overrides& overrides);  // and with what it includes

// The scene on this mesh, whatever mesh its file asks for.
Scene build_scene(const YamlNode& settings, TetMesh mesh, const SceneOptions& options);

inline MesherOptions mesher_options(const SceneOptions& options) {
  return {options.mesher, options.cache_folder, options.meshing_limit_s, options.interrupt};
}
inline void refuse_interrupted(const SceneOptions& options) {
  if (options.interrupt && options.interrupt()) throw std::runtime_error("loading was interrupted");
}
std::string mesh_file(const YamlNode& scene, const MesherOptions& mesher);  // its path in the cache
TetMesh read_mesh(const YamlNode& scene, const SceneOptions& options);      // `body`, `bodies`: their shapes
std::vector<YamlNode> body_sections(const YamlNode& scene);                 // `body`, and the items of `bodies`
std::vector<YamlNode> materials_of(const YamlNode& body);                   // its own, and those of its regions
// The number that says how stiff a material is: none beside a preset or a `stiffness_ratio`.
std::optional<YamlNode> stated_modulus(const YamlNode& material);
bool is_of_file(const YamlNode& body);  // whether its shape has numbers of a file, which `scale` multiplies
Body read_body(const YamlNode& scene, TetMesh mesh);  // `body`, `bodies`, `loads`, gravity, `fibres`
void read_fibres(const YamlNode& scene, Body& body);  // `fibres`
Material read_material(const YamlNode& node);         // `body.material`, or a file of presets
std::vector<std::unique_ptr<Actuator>> read_actuators(
    const YamlNode& scene, const Body& body, const MeshLocator& locator,
    const ActuatorFactory& factory);  // `cables`, `chambers`, `actuators`
std::vector<Marker> read_markers(const YamlNode& scene, const Body& body, const MeshLocator& locator);
std::vector<ObstaclePose> read_motion(const YamlNode& item);  // `motion` of an obstacle or a held region
void read_contact(const YamlNode& scene, const MesherOptions& mesher, Body& body);  // `contact`
MeshShape read_mesh_shape(const YamlNode& obstacle, const MesherOptions& mesher);   // its file, scale and position
// The file's method gives way to this one, and what only that knows; empty: the file's stays.
YamlNode with_method(const YamlNode& stated, const std::string& method);
SolverOptions read_solver(const YamlNode& scene);                           // `solver`
RunSettings read_run(const YamlNode& scene, const Simulation& simulation);  // `run`
// What other programs go by: `casting` and `parameters`. A scene with them is checked, and counts as read.
void read_for_others(const YamlNode& scene);

// A scene's file and those that it includes, in the order of reading, without links. Throws SettingsError.
std::vector<std::string> files_of_scene(const std::string& path);

// `body` in an item of a list: which body of the mesh it belongs to; none where it may be any.
std::optional<int> read_owner(const YamlNode& item, const TetMesh& mesh);

// What a part refuses becomes an error at the section's file and line.
template <typename Build>
auto in_section(const YamlNode& node, const Build& build) {
  try {
    return build();
  } catch (const SettingsError&) {
    throw;
  } catch (const std::invalid_argument& error) {
    node.fail(error.what());
  }
}

}  // namespace soft_robot_lab
