// SPDX-License-Identifier: BSD-3-Clause
#include "skin.h"
#include "nearest_on_triangle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "shape_functions.h"

namespace soft_robot_lab {
namespace {

constexpr double kOnEdge = 1e-9;    // in reference coordinates
constexpr double kSame = 1e-9;      // of the line: crossings at an edge that faces share
constexpr double kBulge = 0.15;     // of a face's box: how far a curved one may reach beyond its nodes
constexpr double kParallel = 1e-9;  // sine of the angle between a line and a face along which it runs

Eigen::Matrix3d corners_of(const Eigen::Matrix3Xd& positions_m, const Eigen::Vector3i& nodes) {
  Eigen::Matrix3d corners;
  for (int i = 0; i < 3; ++i) corners.col(i) = positions_m.col(nodes[i]);
  return corners;
}

// Of a point in the triangle's plane.
Eigen::Vector3d barycentric(const Eigen::Matrix3d& corners, const Eigen::Vector3d& at) {
  const Eigen::Vector3d u = corners.col(1) - corners.col(0), v = corners.col(2) - corners.col(0);
  const Eigen::Vector3d n = u.cross(v), way = at - corners.col(0);
  const double b = n.dot(way.cross(v)) / n.squaredNorm(), c = n.dot(u.cross(way)) / n.squaredNorm();
  return {1.0 - b - c, b, c};
}

// The nodes of a face's triangle, or of the four that stand for a curved one.
template <typename Visit>
void for_flat_triangles(const TetMesh& mesh, Eigen::Index face, const Visit& visit) {
  const auto nodes = [&](const std::array<int, 3>& part) {
    return Eigen::Vector3i(mesh.faces(part[0], face), mesh.faces(part[1], face), mesh.faces(part[2], face));
  };
  if (mesh.faces.rows() == 3) return visit(nodes({0, 1, 2}));
  for (const std::array<int, 3>& part : kFaceQuarters) visit(nodes(part));
}

struct Line {
  Eigen::Vector3d from_m, way_m;
  Eigen::Matrix<double, 2, 3> across;  // two directions across it

  Line(const Eigen::Vector3d& from, const Eigen::Vector3d& to) : from_m(from), way_m(to - from) {
    const Eigen::Vector3d u = way_m.unitOrthogonal();
    across << u.transpose(), way_m.normalized().cross(u).transpose();
  }
  double share(const Eigen::Vector3d& point_m) const { return (point_m - from_m).dot(way_m) / way_m.squaredNorm(); }
};

bool may_meet(const Line& line, const Eigen::Matrix3Xd& face_m) {
  const Eigen::Vector3d to_m = line.from_m + line.way_m;
  const Eigen::Array3d least = face_m.rowwise().minCoeff(), most = face_m.rowwise().maxCoeff();
  const double margin = kBulge * (most - least).matrix().norm();
  return (line.from_m.cwiseMin(to_m).array() <= most + margin).all() &&
         (line.from_m.cwiseMax(to_m).array() >= least - margin).all();
}

// By Newton's method on the two distances across the line, from a place (r, s) of the face.
std::optional<SkinCrossing> crossing(const Line& line, const Eigen::Matrix3Xd& face_m, Eigen::Vector2d place) {
  for (int iteration = 0; iteration < 30; ++iteration) {
    const FaceShape shape = face_shape(face_m.cols(), place[0], place[1]);
    const Eigen::Vector3d at_m = face_m * shape.values;
    const Eigen::Matrix<double, 3, 2> slopes = face_m * shape.slopes.transpose();
    const Eigen::Matrix2d seen = line.across * slopes;
    if (!(std::abs(seen.determinant()) > kParallel * slopes.col(0).norm() * slopes.col(1).norm())) return std::nullopt;
    const Eigen::Vector2d step = -seen.inverse() * (line.across * (at_m - line.from_m));
    place += step;
    if (place.norm() > 10.0) return std::nullopt;
    if (step.norm() > 1e-12) continue;
    if (place.minCoeff() < -kOnEdge || place.sum() > 1.0 + kOnEdge) return std::nullopt;
    const double share = line.share(face_m * face_shape(face_m.cols(), place[0], place[1]).values);
    if (share < -kSame || share > 1.0 + kSame) return std::nullopt;
    return SkinCrossing{share, slopes.col(0).cross(slopes.col(1)).normalized()};
  }
  return std::nullopt;
}

// A curved face may be met more than once: a start in the middle of each of its quarters.
void add_crossings(const Line& line, const Eigen::Matrix3Xd& face_m, std::vector<SkinCrossing>& all) {
  static const Eigen::Vector2d starts[] = {{1. / 6, 1. / 6}, {2. / 3, 1. / 6}, {1. / 6, 2. / 3}, {1. / 3, 1. / 3}};
  for (const Eigen::Vector2d& start : starts)
    if (const auto one = crossing(line, face_m, start)) all.push_back(*one);
}

}  // namespace

SkinPoint nearest_on_skin(const TetMesh& mesh, const Eigen::Vector3d& point_m) {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(mesh.faces.cols()));
  std::iota(all.begin(), all.end(), 0);
  return nearest_on_skin(mesh, all, point_m);
}

SkinPoint nearest_on_skin(const TetMesh& mesh, const std::vector<Eigen::Index>& faces, const Eigen::Vector3d& point_m) {
  SkinPoint nearest{point_m, std::numeric_limits<double>::infinity()};
  for (const Eigen::Index face : faces)
    for_flat_triangles(mesh, face, [&](const Eigen::Vector3i& nodes) {
      const Eigen::Vector3d candidate = nearest_on_triangle(point_m, corners_of(mesh.nodes_m, nodes)).at_m;
      const double distance_m = (candidate - point_m).norm();
      if (distance_m < nearest.distance_m) nearest = {candidate, distance_m};
    });
  return nearest;
}

GripPlace grip_on_skin(const TetMesh& mesh, const Eigen::Matrix3Xd& positions_m, const Eigen::Vector3d& point_m) {
  GripPlace place{point_m, Eigen::Vector3d::Zero(), std::numeric_limits<double>::infinity()};
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for_flat_triangles(mesh, face, [&](const Eigen::Vector3i& nodes) {
      const Eigen::Vector3d at_m = nearest_on_triangle(point_m, corners_of(positions_m, nodes)).at_m;
      const double distance_m = (at_m - point_m).norm();
      if (!(distance_m < place.distance_m)) return;
      place.distance_m = distance_m;
      const Eigen::Matrix3d rest_m = corners_of(mesh.nodes_m, nodes);
      place.rest_m = rest_m * barycentric(corners_of(positions_m, nodes), at_m);
      place.rest_normal = (rest_m.col(1) - rest_m.col(0)).cross(rest_m.col(2) - rest_m.col(0)).normalized();
    });
  return place;
}

std::vector<SkinCrossing> skin_crossings(const TetMesh& mesh, const Eigen::Vector3d& from_m,
                                         const Eigen::Vector3d& to_m) {
  const Line line(from_m, to_m);
  std::vector<SkinCrossing> all;
  Eigen::Matrix3Xd face_m(3, mesh.faces.rows());
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    for (Eigen::Index a = 0; a < face_m.cols(); ++a) face_m.col(a) = mesh.nodes_m.col(mesh.faces(a, face));
    if (may_meet(line, face_m)) add_crossings(line, face_m, all);
  }
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.share < b.share; });
  const auto same = [](const auto& a, const auto& b) { return b.share - a.share < kSame; };
  all.erase(std::unique(all.begin(), all.end(), same), all.end());
  return all;
}

}  // namespace soft_robot_lab
