// SPDX-License-Identifier: BSD-3-Clause
#include "convert_mesh.h"

#include <filesystem>
#include <stdexcept>

#include <gmsh.h>

#include "gmsh_model.h"
#include "read_vtk.h"

namespace soft_robot_lab {
namespace {

std::vector<NamedSurface> physical_surfaces() {
  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups, 2);
  std::vector<NamedSurface> surfaces;
  for (const auto& [dimension, tag] : groups) {
    NamedSurface surface;
    gmsh::model::getPhysicalName(dimension, tag, surface.name);
    if (surface.name.empty()) surface.name = std::to_string(tag);
    gmsh::model::getEntitiesForPhysicalGroup(dimension, tag, surface.entities);
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
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
  return extract_mesh(physical_surfaces(), 1.0);
}

}  // namespace soft_robot_lab
