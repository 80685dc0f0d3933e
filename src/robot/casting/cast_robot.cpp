// SPDX-License-Identifier: BSD-3-Clause
#include "cast_robot.h"

#include "robot/design/mesh_quality.h"
#include "robot/design/surface_file.h"
#include "robot/scene/sections.h"
#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {
namespace {

constexpr double kEdgesAcross = 50;  // of the body's box: round sides get more by their curvature

Surface surface_of_mesh(TetMesh mesh) {
  complete_boundary(mesh);
  return make_surface(mesh.nodes_m, mesh.faces.topRows(3));
}

Surface surface_of_solid(const std::string& solid_yaml, const TetMesh& mesh, const MesherOptions& options) {
  const Eigen::Vector3d size_m = mesh.nodes_m.rowwise().maxCoeff() - mesh.nodes_m.rowwise().minCoeff();
  SurfaceRequest request;
  request.solid_yaml = solid_yaml;
  request.largest_edge_m = size_m.norm() / kEdgesAcross;
  return read_off(surface_file_for(request, options));
}

std::vector<SheathPath> read_sheaths(const YamlNode& robot, double default_radius_m) {
  std::vector<SheathPath> paths;
  for (const YamlNode& cable : robot.optional_sequence("cables")) {
    SheathPath path;
    path.name = cable.text("name");
    path.radius_m = cable.number_or("sheath_radius_m", default_radius_m);
    if (!(path.radius_m > 0)) path.radius_m = default_radius_m;
    for (const YamlNode& point : cable_path(cable)) path.points_m.push_back(as_vector3(point));
    paths.push_back(std::move(path));
  }
  return paths;
}

}  // namespace

CastRobotFile load_cast_robot(const std::string& path, const SceneOptions& options) {
  const Scene scene = load_scene(path, options);
  const Body& body = scene.simulation->body();
  const YamlNode settings = merge_overrides(YamlNode::load_file(path), options.overrides);
  CastRobotFile file;
  file.settings = read_casting_settings(settings);
  file.mesher = mesher_options(options);
  const YamlNode section = settings.child("body");
  if (section.has("solid")) file.solid_yaml = to_yaml(read_solid(section.child("solid")));
  file.robot.surface = in_section(section, [&] {
    return file.solid_yaml.empty() ? surface_of_mesh(body.mesh())
                                   : surface_of_solid(file.solid_yaml, body.mesh(), mesher_options(options));
  });
  file.robot.youngs_modulus_pa = body.material().youngs_modulus_pa;
  file.robot.density_kg_m3 = body.material().density_kg_m3;
  file.robot.sheaths = read_sheaths(settings, file.settings.sheath.radius_m);
  file.robot.mesh_qualities = volume_length_qualities(body.mesh().nodes_m, body.mesh().tets);
  return file;
}

}  // namespace soft_robot_lab
