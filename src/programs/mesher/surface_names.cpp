#include "programs/mesher/surface_names.h"

#include <algorithm>

#include <Eigen/Core>
#include <gmsh.h>

#include "programs/mesher/solid_geometry.h"

namespace soft_robot_lab {
namespace {

constexpr double kOnSurface = 1e-4;  // kernel units: 1e-7 m
constexpr size_t kSamples = 25;      // per surface

struct NamedSolid {
  const Solid* solid;
  int depth;
  std::vector<int> boundary = {};  // surface entities in the model of named solids
};

void collect(const Solid& solid, int depth, std::vector<NamedSolid>& named) {
  if (!solid.name.empty()) named.push_back({&solid, depth});
  for (const Solid& part : solid.parts) collect(part, depth + 1, named);
}

// The strongest name first.
std::vector<NamedSolid> named_solids(const Solid& solid) {
  std::vector<NamedSolid> named;
  collect(solid, 0, named);
  std::reverse(named.begin(), named.end());
  std::stable_sort(named.begin(), named.end(), [](const auto& a, const auto& b) { return a.depth > b.depth; });
  return named;
}

std::vector<int> boundary_of(const gmsh::vectorpair& volumes) {
  gmsh::vectorpair entities;
  gmsh::model::getBoundary(volumes, entities, false, false, false);
  std::vector<int> tags;
  for (const auto& entity : entities) tags.push_back(entity.second);
  return tags;
}

std::vector<double> closest(int surface, const std::vector<double>& points, std::vector<double>& parameters) {
  std::vector<double> found;
  gmsh::model::getClosestPoint(2, surface, points, found, parameters);
  return found;
}

// Points of a surface: centres of its triangles, put onto the exact surface.
std::vector<Eigen::Vector3d> sample_points(int surface) {
  std::vector<std::size_t> tags, nodes;
  gmsh::model::mesh::getElementsByType(2, tags, nodes, surface);
  const size_t count = std::min(kSamples, tags.size());
  std::vector<Eigen::Vector3d> points;
  for (size_t i = 0; i < count; ++i) {
    const size_t triangle = i * tags.size() / count;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (size_t corner = 0; corner < 3; ++corner) {
      std::vector<double> at, unused;
      gmsh::model::mesh::getNode(nodes[3 * triangle + corner], at, unused);
      centre += Eigen::Vector3d::Map(at.data()) / 3;
    }
    std::vector<double> parameters;
    points.emplace_back(
        Eigen::Vector3d::Map(closest(surface, {centre.x(), centre.y(), centre.z()}, parameters).data()));
  }
  return points;
}

bool lies_on(const Eigen::Vector3d& point, int surface) {
  std::vector<double> parameters;
  const std::vector<double> found = closest(surface, {point.x(), point.y(), point.z()}, parameters);
  if ((Eigen::Vector3d::Map(found.data()) - point).norm() > kOnSurface) return false;
  return gmsh::model::isInside(2, surface, parameters) == 1;
}

bool mostly_on(const std::vector<Eigen::Vector3d>& points, const NamedSolid& named) {
  const auto on = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
    return std::any_of(named.boundary.begin(), named.boundary.end(), [&](int tag) { return lies_on(point, tag); });
  });
  return 2 * static_cast<size_t>(on) > points.size();
}

void add(std::vector<NamedSurface>& surfaces, const std::string& name, int entity) {
  auto same = std::find_if(surfaces.begin(), surfaces.end(), [&](const auto& s) { return s.name == name; });
  if (same == surfaces.end()) same = surfaces.insert(surfaces.end(), NamedSurface{name, {}});
  same->entities.push_back(entity);
}

}  // namespace

std::vector<NamedSurface> name_surfaces(int body, const Solid& solid) {
  std::vector<NamedSolid> names = named_solids(solid);
  if (names.empty()) return {};
  const std::vector<int> entities = boundary_of({{3, body}});
  std::vector<std::vector<Eigen::Vector3d>> points;
  for (const int entity : entities) points.push_back(sample_points(entity));

  std::string model;
  gmsh::model::getCurrent(model);
  gmsh::model::add("named solids");
  for (NamedSolid& named : names) named.boundary = boundary_of(build_solid(*named.solid));
  std::vector<NamedSurface> surfaces;
  for (size_t i = 0; i < entities.size(); ++i) {
    const auto owner =
        std::find_if(names.begin(), names.end(), [&](const auto& named) { return mostly_on(points[i], named); });
    if (owner != names.end()) add(surfaces, owner->solid->name, entities[i]);
  }
  gmsh::model::setCurrent(model);
  return surfaces;
}

}  // namespace soft_robot_lab
