// SPDX-License-Identifier: BSD-3-Clause
#include "contact_points.h"

#include <cmath>

#include <Eigen/Geometry>

#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {
namespace {

// The rule of degree 2 inside a triangle, weight 1/6 each (Strang & Fix 1973).
constexpr double kPlaces[kPointsPerFace][2] = {{1.0 / 6.0, 1.0 / 6.0}, {2.0 / 3.0, 1.0 / 6.0}, {1.0 / 6.0, 2.0 / 3.0}};

bool held(const Body& body, Eigen::Index face) {
  for (Eigen::Index a = 0; a < body.mesh().faces.rows(); ++a)
    if (!body.fixed().col(body.mesh().faces(a, face)).all()) return false;
  return true;
}

}  // namespace

ContactPoints::ContactPoints(const Body& body) {
  const TetMesh& mesh = body.mesh();
  for (int face = 0; face < mesh.faces.cols(); ++face)
    if (!held(body, face)) mesh_faces_.push_back(face);
  faces_ = mesh.faces(Eigen::all, mesh_faces_);
  const int nodes = nodes_per_face();
  shape_.resize(nodes, kPointsPerFace);
  along_r_.resize(nodes, kPointsPerFace);
  along_s_.resize(nodes, kPointsPerFace);
  for (int place = 0; place < kPointsPerFace; ++place) {
    const FaceShape shape = face_shape(nodes, kPlaces[place][0], kPlaces[place][1]);
    shape_.col(place) = shape.values;
    along_r_.col(place) = shape.slopes.row(0).transpose();
    along_s_.col(place) = shape.slopes.row(1).transpose();
  }
  weights_m2_.resize(kPointsPerFace * faces_.cols());
  sizes_m_.resize(faces_.cols());
  for (int face = 0; face < face_count(); ++face) {
    for (int place = 0; place < kPointsPerFace; ++place)
      weights_m2_[kPointsPerFace * face + place] = present_area_m2(kPointsPerFace * face + place, mesh.nodes_m);
    sizes_m_[face] = std::sqrt(2.0 * weights_m2_.segment<kPointsPerFace>(kPointsPerFace * face).sum());
  }
}

Eigen::Vector3d ContactPoints::at(int point, const Eigen::Matrix3Xd& columns) const {
  const int face = face_of(point), place = point % kPointsPerFace;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int a = 0; a < nodes_per_face(); ++a) sum += shape_(a, place) * columns.col(faces_(a, face));
  return sum;
}

Eigen::Vector3d ContactPoints::outward_m2(int point, const Eigen::Matrix3Xd& positions_m) const {
  const int face = face_of(point), place = point % kPointsPerFace;
  Eigen::Vector3d along_r = Eigen::Vector3d::Zero(), along_s = Eigen::Vector3d::Zero();
  for (int a = 0; a < nodes_per_face(); ++a) {
    along_r += along_r_(a, place) * positions_m.col(faces_(a, face));
    along_s += along_s_(a, place) * positions_m.col(faces_(a, face));
  }
  return along_r.cross(along_s) / (2.0 * kPointsPerFace);
}

double ContactPoints::present_area_m2(int point, const Eigen::Matrix3Xd& positions_m) const {
  return outward_m2(point, positions_m).norm();
}

}  // namespace soft_robot_lab
