// SPDX-License-Identifier: BSD-3-Clause
// Meshing in a separate program with a time limit, cached by content. Gmsh itself is never linked here: it is GPL, and
// it may hang.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/robot/design/solid.h"

namespace soft_robot_lab {

// Where elements shall be no larger than `size_m`: in a ball, around a cable's plug for instance, or along a named
// surface of the solid, or along the edges of that surface's sides, where stresses peak.
struct MeshRefinement {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;  // does nothing, as center_m, where a surface is named
  double size_m = 0.0;
  std::string surface = {};
  bool edges_only = false;
};

// {center_m, radius_m, size_m}, {surface, size_m} or {edges_of, size_m}. Throws SettingsError.
MeshRefinement read_mesh_refinement(const YamlNode& node);

struct MeshRequest {
  std::optional<Solid> solid;    // or
  std::string mesh_file;         // an existing .msh or .vtk file to convert, with
  double mesh_unit_m = 1.0;      // its unit; the members below do nothing then
  double element_size_m = 0.01;  // > 0
  bool quadratic = true;         // 10-node elements that follow curved surfaces
  std::vector<MeshRefinement> refinements;
  std::vector<std::string> regions;  // named solids whose elements are kept apart, with faces where they meet others
};

struct MesherOptions {
  std::string program;  // mesh_robot; empty: beside the running program, in ../lib/soft_robot_lab, then on PATH
  // Empty: $XDG_CACHE_HOME/soft_robot_lab, or ~/.cache/soft_robot_lab, or a private folder among temporary files.
  std::string cache_folder;
  double time_limit_s = 120.0;
  std::function<bool()> interrupt = {};  // asked while a mesh is made: true kills the mesher; empty: never
};

// Where meshes, and what others found out about them, are kept by content.
std::string cache_folder(const MesherOptions& options);

// The path of an MSH 2.2 text file for the request, made now or found in the cache. Safe against a second process doing
// the same. Throws std::invalid_argument with the mesher's own words, or std::runtime_error when the time limit passed
// or it was interrupted.
std::string mesh_file_for(const MeshRequest& request, const MesherOptions& options);

}  // namespace soft_robot_lab
