// SPDX-License-Identifier: BSD-3-Clause
#include "surface_names.h"

#include <algorithm>

#include <Eigen/Core>
#include <gmsh.h>

#include "solid_geometry.h"

namespace soft_robot_lab {
namespace {

constexpr double kOnSurface = 1e-5;  // kernel units: 1e-8 m
constexpr size_t kNameSamples = 25;  // per surface

// Points of a surface: centres of its triangles, put onto the exact surface.
std::vector<Eigen::Vector3d> sample_points(int surface) {
  std::vector<std::size_t> tags, nodes;
  gmsh::model::mesh::getElementsByType(2, tags, nodes, surface);
  const size_t count = std::min(kNameSamples, tags.size());
  std::vector<Eigen::Vector3d> points;
  for (size_t i = 0; i < count; ++i) {
    const size_t triangle = i * tags.size() / count;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (size_t corner = 0; corner < 3; ++corner) {
      std::vector<double> at, unused;
      gmsh::model::mesh::getNode(nodes[3 * triangle + corner], at, unused);
      centre += Eigen::Vector3d::Map(at.data()) / 3;
    }
    std::vector<double> on_surface, unused;
    gmsh::model::getClosestPoint(2, surface, {centre.x(), centre.y(), centre.z()}, on_surface, unused);
    points.emplace_back(Eigen::Vector3d::Map(on_surface.data()));
  }
  return points;
}

// For each surface, given by its points, whether most of them lie on the boundary of the solid. The kernel
// intersects the points with the trimmed boundary, which Gmsh's getClosestPoint() does not know.
std::vector<bool> find_on_boundary(const std::vector<std::vector<Eigen::Vector3d>>& surfaces, const Solid& solid) {
  gmsh::vectorpair boundary, points, found;
  const gmsh::vectorpair volumes = build_solid(solid);
  if (volumes.empty()) return std::vector<bool>(surfaces.size(), false);
  gmsh::model::getBoundary(volumes, boundary, false, false, false);
  for (const auto& surface : surfaces) {
    for (const auto& p : surface) points.emplace_back(0, gmsh::model::occ::addPoint(p.x(), p.y(), p.z()));
  }
  std::vector<gmsh::vectorpair> found_of;
  gmsh::option::setNumber("Geometry.ToleranceBoolean", kOnSurface);
  gmsh::model::occ::intersect(points, boundary, found, found_of);
  gmsh::option::setNumber("Geometry.ToleranceBoolean", 0);
  std::vector<bool> on_boundary;
  size_t next = 0;
  for (const auto& surface : surfaces) {
    size_t hits = 0;
    for (size_t i = 0; i < surface.size(); ++i) hits += found_of[next++].empty() ? 0 : 1;
    on_boundary.push_back(2 * hits > surface.size());
  }
  return on_boundary;
}

void add(std::vector<NamedEntities>& surfaces, const std::string& name, int entity) {
  auto same = std::find_if(surfaces.begin(), surfaces.end(), [&](const auto& s) { return s.name == name; });
  if (same == surfaces.end()) same = surfaces.insert(surfaces.end(), NamedEntities{name, {}});
  same->entities.push_back(entity);
}

}  // namespace

std::vector<NamedEntities> name_surfaces(const gmsh::vectorpair& volumes, const Solid& solid) {
  const std::vector<Solid> names = named_solids(solid);
  if (names.empty()) return {};
  gmsh::vectorpair entities;
  const bool without_faces_between = volumes.size() > 1;
  gmsh::model::getBoundary(volumes, entities, without_faces_between, false, false);
  std::vector<std::vector<Eigen::Vector3d>> points;
  for (const auto& entity : entities) points.push_back(sample_points(entity.second));

  std::string model;
  gmsh::model::getCurrent(model);
  std::vector<NamedEntities> surfaces;
  std::vector<bool> is_named(entities.size(), false);
  for (const Solid& named : names) {
    gmsh::model::add("named solid");
    const std::vector<bool> on_boundary = find_on_boundary(points, named);
    gmsh::model::remove();
    for (size_t i = 0; i < entities.size(); ++i) {
      if (!on_boundary[i] || is_named[i]) continue;
      is_named[i] = true;
      add(surfaces, named.name, entities[i].second);
    }
  }
  gmsh::model::setCurrent(model);
  return surfaces;
}

}  // namespace soft_robot_lab
