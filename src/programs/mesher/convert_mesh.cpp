// SPDX-License-Identifier: BSD-3-Clause
#include "convert_mesh.h"

#include <filesystem>
#include <map>
#include <stdexcept>

#include <gmsh.h>

#include "gmsh_model.h"
#include "read_vtk.h"

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

}  // namespace

TetMesh convert_mesh(const std::string& file) {
  const std::string kind = std::filesystem::path(file).extension();
  if (kind != ".msh" && kind != ".vtk")
    throw std::invalid_argument(file + ": only .msh and .vtk files can be converted");
  if (!std::filesystem::is_regular_file(file)) throw std::invalid_argument("there is no file " + file);
  if (kind == ".vtk") return read_vtk(file);
  const GmshSession session;
  gmsh::open(file);
  return extract_mesh(physical_groups(2), regions(), 1.0);
}

}  // namespace soft_robot_lab
