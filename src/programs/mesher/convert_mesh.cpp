// SPDX-License-Identifier: BSD-3-Clause
#include "convert_mesh.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <vector>

#include <gmsh.h>

#include "gmsh_model.h"
#include "msh_counts.h"
#include "read_vtk.h"
#include "mechanics/mesh/tet_faces.h"
#include "settings/point_text.h"

namespace soft_robot_lab {
namespace {

std::vector<NamedEntities> physical_groups(int of_dimension) {
  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups, of_dimension);
  std::vector<NamedEntities> named;
  for (const auto& [dimension, tag] : groups) {
    NamedEntities group;
    gmsh::model::getPhysicalName(dimension, tag, group.name);
    if (group.name.empty()) group.name = std::to_string(tag);
    gmsh::model::getEntitiesForPhysicalGroup(dimension, tag, group.entities);
    named.push_back(std::move(group));
  }
  return named;
}

// Volumes of no group are a region without a name.
std::vector<NamedEntities> regions() {
  std::vector<NamedEntities> groups = physical_groups(3);
  std::map<int, std::string> group_of;
  for (const NamedEntities& group : groups)
    for (const int entity : group.entities)
      if (const auto [first, is_new] = group_of.emplace(entity, group.name); !is_new)
        throw std::invalid_argument("elements lie in two volume groups: '" + first->second + "' and '" + group.name +
                                    "'");
  gmsh::vectorpair volumes;
  gmsh::model::getEntities(volumes, 3);
  NamedEntities rest;
  for (const auto& [dimension, entity] : volumes)
    if (group_of.count(entity) == 0) rest.entities.push_back(entity);
  if (!groups.empty() && !rest.entities.empty()) groups.push_back(std::move(rest));
  return groups;
}

std::string lower_ending(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

TetMesh read_any(const std::string& file) {
  require_mesh_ending(file);
  if (lower_ending(file) == ".vtk") return read_vtk(file);
  check_msh_counts(file);
  const GmshSession session;
  try {
    gmsh::open(file);
  } catch (const std::string& error) {
    if (error.rfind("Error loading", 0) == 0)  // where it says no more
      throw std::invalid_argument("cannot be read: a section is broken off, or a number in it is none");
    throw;
  }
  return extract_mesh(physical_groups(2), regions(), 1.0);
}

}  // namespace

void require_mesh_ending(const std::string& file) {
  const std::string ending = lower_ending(file);
  if (ending == ".vtu")
    throw std::invalid_argument(
        ".vtu is not read here; save it as a legacy VTK file, .vtk (ParaView: File, Save Data, VTK Legacy Files)");
  if (ending != ".vtk" && ending != ".msh")
    throw std::invalid_argument("'" + ending + "' files are not read here, only .msh and .vtk");
}

TetMesh read_mesh_file(const std::string& file, double unit_m) {
  if (!std::filesystem::is_regular_file(file)) throw std::invalid_argument("there is no such file");
  TetMesh mesh = read_any(file);
  mesh.nodes_m *= unit_m;
  if (!mesh.nodes_m.allFinite()) throw std::invalid_argument("a node is not at a finite place");
  return mesh;
}

void turn_faces_outward(TetMesh& mesh) {
  const TetSides sides(mesh);
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    const auto corners = mesh.faces.col(face);
    const std::vector<TetSide> meeting = sides.meeting(face_key(corners[0], corners[1], corners[2]));
    if (meeting.size() == 1) {
      mesh.faces.col(face) = meeting[0].nodes(mesh);
      continue;
    }
    const std::string& name = mesh.surface_names[static_cast<size_t>(mesh.face_surface[static_cast<size_t>(face)])];
    const Eigen::Vector3d at_m =
        (mesh.nodes_m.col(corners[0]) + mesh.nodes_m.col(corners[1]) + mesh.nodes_m.col(corners[2])) / 3;
    throw std::invalid_argument("a triangle of the surface '" + name + "' at " + point_text(at_m) +
                                (meeting.empty() ? " is no side of an element" : " lies inside the body"));
  }
}

TetMesh convert_mesh(const std::string& file, double unit_m) {
  TetMesh mesh = read_mesh_file(file, unit_m);
  turn_faces_outward(mesh);
  check_mesh(mesh);
  return mesh;
}

}  // namespace soft_robot_lab
