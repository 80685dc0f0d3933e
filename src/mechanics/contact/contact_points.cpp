// SPDX-License-Identifier: BSD-3-Clause
#include "contact_points.h"

#include <cmath>

#include <Eigen/Geometry>

#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {
namespace {

// The rule of degree 2 inside a triangle (Strang & Fix 1973), in each of the parts^2 triangles of a lattice. All places
// have one weight.
std::vector<Eigen::Vector2d> places_inside(int parts) {
  const double side = 1.0 / parts;
  std::vector<Eigen::Vector2d> places;
  const auto add = [&](const Eigen::Vector2d& corner, double to) {
    for (const Eigen::Vector2d& at : {Eigen::Vector2d(1, 1), Eigen::Vector2d(4, 1), Eigen::Vector2d(1, 4)})
      places.emplace_back(corner + to / 6.0 * at);
  };
  for (int i = 0; i < parts; ++i) {
    for (int j = 0; i + j < parts; ++j) {
      add({i * side, j * side}, side);
      if (i + j + 1 < parts) add({(i + 1) * side, (j + 1) * side}, -side);
    }
  }
  return places;
}

bool held(const Body& body, Eigen::Index face) {
  for (Eigen::Index a = 0; a < body.mesh().faces.rows(); ++a)
    if (!body.fixed().col(body.mesh().faces(a, face)).all()) return false;
  return true;
}

}  // namespace

ContactPoints::ContactPoints(const Body& body, PointSpread spread) {
  const TetMesh& mesh = body.mesh();
  for (int face = 0; face < mesh.faces.cols(); ++face)
    if (!held(body, face)) mesh_faces_.push_back(face);
  faces_ = mesh.faces(Eigen::all, mesh_faces_);
  const std::vector<Eigen::Vector2d> places = places_inside(spread == PointSpread::sparse ? 1 : 2);
  per_face_ = static_cast<int>(places.size());
  shape_.resize(nodes_per_face(), per_face_);
  along_r_.resize(nodes_per_face(), per_face_);
  along_s_.resize(nodes_per_face(), per_face_);
  for (int place = 0; place < per_face_; ++place) {
    const Eigen::Vector2d& at = places[static_cast<std::size_t>(place)];
    const FaceShape shape = face_shape(nodes_per_face(), at.x(), at.y());
    shape_.col(place) = shape.values;
    along_r_.col(place) = shape.slopes.row(0).transpose();
    along_s_.col(place) = shape.slopes.row(1).transpose();
  }
  weights_m2_.resize(per_face_ * faces_.cols());
  sizes_m_.resize(face_count());
  for (int face = 0; face < face_count(); ++face) {
    for (int point = first_point(face); point < first_point(face + 1); ++point)
      weights_m2_[point] = present_area_m2(point, mesh.nodes_m);
    sizes_m_[face] = std::sqrt(2.0 * weights_m2_.segment(first_point(face), per_face_).sum());
  }
}

Eigen::Vector3d ContactPoints::at(int point, const Eigen::Matrix3Xd& columns) const {
  const int face = face_of(point), place = point % per_face_;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int a = 0; a < nodes_per_face(); ++a) sum += shape_(a, place) * columns.col(faces_(a, face));
  return sum;
}

Eigen::Vector3d ContactPoints::outward_m2(int point, const Eigen::Matrix3Xd& positions_m) const {
  const int face = face_of(point), place = point % per_face_;
  Eigen::Vector3d along_r = Eigen::Vector3d::Zero(), along_s = Eigen::Vector3d::Zero();
  for (int a = 0; a < nodes_per_face(); ++a) {
    along_r += along_r_(a, place) * positions_m.col(faces_(a, face));
    along_s += along_s_(a, place) * positions_m.col(faces_(a, face));
  }
  return along_r.cross(along_s) / (2.0 * per_face_);
}

double ContactPoints::present_area_m2(int point, const Eigen::Matrix3Xd& positions_m) const {
  return outward_m2(point, positions_m).norm();
}

}  // namespace soft_robot_lab
