// SPDX-License-Identifier: BSD-3-Clause
#include "stl_body.h"

#include <stdexcept>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>
#include <gmsh.h>

#include "check_surface.h"

namespace soft_robot_lab {
namespace {

using Kind = Solid::Kind;

constexpr double kSameVertex = 1e-6;  // of the surface's size: what single precision makes of one place

bool moves_one(const Solid& solid) { return solid.moves() && solid.kind != Kind::array; }

const Solid& innermost(const Solid& solid) { return moves_one(solid) ? innermost(solid.parts[0]) : solid; }

// Inner moves come first.
Eigen::Affine3d placement(const Solid& solid) {
  if (!moves_one(solid)) return Eigen::Affine3d::Identity();
  const Eigen::Vector3d n = solid.axis.normalized();
  Eigen::Affine3d about = Eigen::Affine3d::Identity();
  if (solid.kind == Kind::rotate) about = Eigen::AngleAxisd(solid.angle_deg * M_PI / 180, n);
  if (solid.kind == Kind::scale) about = Eigen::Scaling(solid.factor);
  if (solid.kind == Kind::mirror) about.linear() -= 2 * n * n.transpose();
  const Eigen::Translation3d there(solid.center_m + solid.by_m), back(-solid.center_m);
  return there * about * back * placement(solid.parts[0]);
}

Eigen::Matrix3Xd place_vertices(const Solid& solid, std::vector<std::size_t>& tags) {
  const Eigen::Affine3d place = placement(solid);
  std::vector<double> positions, unused;
  gmsh::model::mesh::getNodes(tags, positions, unused);
  Eigen::Matrix3Xd vertices_m(3, static_cast<Eigen::Index>(tags.size()));
  for (size_t i = 0; i < tags.size(); ++i) {
    const Eigen::Vector3d at = place * Eigen::Map<const Eigen::Vector3d>(&positions[3 * i]);
    vertices_m.col(static_cast<Eigen::Index>(i)) = at;
    if (moves_one(solid)) gmsh::model::mesh::setNode(tags[i], {at.x(), at.y(), at.z()}, {});
  }
  return vertices_m;
}

// By the order of the tags of vertices.
Eigen::Matrix3Xi facets_of(const std::vector<std::size_t>& vertices) {
  std::unordered_map<std::size_t, int> index;
  for (const std::size_t tag : vertices) index.emplace(tag, static_cast<int>(index.size()));
  std::vector<std::size_t> tags, nodes;
  gmsh::model::mesh::getElementsByType(2, tags, nodes);
  Eigen::Matrix3Xi facets(3, static_cast<Eigen::Index>(tags.size()));
  for (Eigen::Index i = 0; i < facets.size(); ++i) facets(i) = index.at(nodes[static_cast<size_t>(i)]);
  return facets;
}

}  // namespace

bool is_stl_body(const Solid& solid) { return innermost(solid).kind == Kind::stl_file; }

std::string stl_file(const Solid& solid) { return innermost(solid).file; }

void merge_stl(const Solid& solid) {
  double tolerance = 0;
  gmsh::option::getNumber("Geometry.Tolerance", tolerance);
  gmsh::option::setNumber("Geometry.Tolerance", kSameVertex);
  gmsh::merge(stl_file(solid));
  gmsh::option::setNumber("Geometry.Tolerance", tolerance);
  std::vector<std::size_t> tags;
  const Eigen::Matrix3Xd vertices_m = place_vertices(solid, tags);
  try {
    check_surface(vertices_m, facets_of(tags));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(stl_file(solid) + ": " + error.what());
  }
}

std::string stl_name(const Solid& solid) {
  if (!solid.name.empty() || !moves_one(solid)) return solid.name;
  return stl_name(solid.parts[0]);
}

}  // namespace soft_robot_lab
