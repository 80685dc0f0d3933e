// SPDX-License-Identifier: BSD-3-Clause
#include "stl_body.h"

#include <vector>

#include <Eigen/Geometry>
#include <gmsh.h>

namespace soft_robot_lab {
namespace {

using Kind = Solid::Kind;

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

}  // namespace

bool is_stl_body(const Solid& solid) { return innermost(solid).kind == Kind::stl_file; }

std::string stl_file(const Solid& solid) { return innermost(solid).file; }

void merge_stl(const Solid& solid) {
  gmsh::merge(stl_file(solid));
  if (!moves_one(solid)) return;
  const Eigen::Affine3d place = placement(solid);
  std::vector<std::size_t> tags;
  std::vector<double> positions, unused;
  gmsh::model::mesh::getNodes(tags, positions, unused);
  for (size_t i = 0; i < tags.size(); ++i) {
    const Eigen::Vector3d at = place * Eigen::Map<const Eigen::Vector3d>(&positions[3 * i]);
    gmsh::model::mesh::setNode(tags[i], {at.x(), at.y(), at.z()}, {});
  }
}

std::string stl_name(const Solid& solid) {
  if (!solid.name.empty() || !moves_one(solid)) return solid.name;
  return stl_name(solid.parts[0]);
}

}  // namespace soft_robot_lab
