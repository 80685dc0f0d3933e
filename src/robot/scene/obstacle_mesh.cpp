// SPDX-License-Identifier: BSD-3-Clause
// An obstacle's mesh: the surface that the mesher reads, checks and scales, put where the obstacle stands.
#include <Eigen/Geometry>

#include "robot/design/file_solid.h"
#include "robot/design/mesh_formats.h"
#include "robot/design/mesher_run.h"
#include "robot/design/off_file.h"
#include "robot/design/orient.h"
#include "robot/design/surface_file.h"
#include "sections.h"

namespace soft_robot_lab {
namespace {

// Of STEP: a chord of a full circle is off by 1e-3 of its radius.
constexpr double kEdgesAcross = 24.0;
constexpr int kCircleSegments = 72;

// A kernel's faces have orientations of their own; a file's triangles say which side is inside.
void require_outward(const std::string& file, OffFile& surface) {
  const Eigen::Matrix3Xi stated = surface.triangles;
  orient(surface.vertices_m, surface.triangles);
  if (has_ending_of(file, MeshFormat::step)) return;
  const auto turned = (stated.array() != surface.triangles.array()).colwise().any().count();
  if (turned == 0) return;
  throw std::invalid_argument(file + ": " + std::to_string(turned) + " of its " + std::to_string(stated.cols()) +
                              " triangles face inward; turn them, so that it is clear what is inside");
}

Eigen::Isometry3d read_position(const YamlNode& obstacle) {
  const Eigen::Vector3d turn_rad = obstacle.vector3_or("rotation_rad", Eigen::Vector3d::Zero());
  Eigen::Isometry3d position(Eigen::Translation3d(obstacle.vector3_or("position_m", Eigen::Vector3d::Zero())));
  if (!turn_rad.isZero(0.0)) position.rotate(Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()));
  return position;
}

}  // namespace

MeshShape read_mesh_shape(const YamlNode& obstacle, const MesherOptions& mesher) {
  const YamlNode node = obstacle.child("mesh");
  const Solid solid = read_file_solid(obstacle, "mesh");
  const std::string file = referenced_files(solid)[0];
  const Eigen::Isometry3d position = read_position(obstacle);
  const double rounding_m = obstacle.has("rounding_m") ? obstacle.number("rounding_m", AllowedRange::positive()) : 0.0;
  return in_section(node, [&] {
    SurfaceRequest request;
    request.solid = solid;
    request.edges_across = kEdgesAcross;
    request.circle_segments = kCircleSegments;
    OffFile surface = read_off_file(surface_file_for(request, mesher));
    require_outward(file, surface);
    try {
      return mesh_shape(position * surface.vertices_m, surface.triangles, rounding_m);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(file + ": " + error.what());
    }
  });
}

}  // namespace soft_robot_lab
