// SPDX-License-Identifier: BSD-3-Clause
#include "smooth_skin.h"

#include <cmath>

#include <Eigen/Geometry>

#include "geometry/mesh_tree.h"
#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {
namespace {

const double kCrease = std::cos(40.0 * M_PI / 180.0);
constexpr int kRays = 48;        // from each place
constexpr double kReach = 0.33;  // of the body's diagonal

// Derivatives of the six shape functions along the face's coordinates, at each of the six nodes.
struct Slopes {
  Eigen::Matrix<double, 6, 6> r, s;  // function x node

  Slopes() {
    constexpr double places[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}};
    for (int node = 0; node < 6; ++node) {
      const FaceShape shape = face_shape(6, places[node][0], places[node][1]);
      r.col(node) = shape.slopes.row(0).transpose();
      s.col(node) = shape.slopes.row(1).transpose();
    }
  }
};

// Of one face, a column a node; as long as the face is large there.
Eigen::Matrix3Xd face_normals(const Eigen::Matrix3Xd& nodes_m) {
  if (nodes_m.cols() == 3)
    return (nodes_m.col(1) - nodes_m.col(0)).cross(nodes_m.col(2) - nodes_m.col(0)).replicate(1, 3);
  static const Slopes slopes;
  const Eigen::Matrix<double, 3, 6> along_r = nodes_m * slopes.r, along_s = nodes_m * slopes.s;
  Eigen::Matrix3Xd normals(3, 6);
  for (int node = 0; node < 6; ++node) normals.col(node) = along_r.col(node).cross(along_s.col(node));
  return normals;
}

Eigen::Matrix3Xd nodes_of(const Eigen::Matrix3Xd& positions_m, const Eigen::MatrixXi& faces, Eigen::Index face) {
  Eigen::Matrix3Xd nodes_m(3, faces.rows());
  for (Eigen::Index k = 0; k < faces.rows(); ++k) nodes_m.col(k) = positions_m.col(faces(k, face));
  return nodes_m;
}

// Directions about +z, as many the nearer to it (Malley's method on a spiral, so that they are the same each time).
std::vector<Eigen::Vector3d> rays() {
  std::vector<Eigen::Vector3d> directions;
  const double golden = M_PI * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < kRays; ++i) {
    const double share = (i + 0.5) / kRays, radius = std::sqrt(share);
    directions.emplace_back(radius * std::cos(golden * i), radius * std::sin(golden * i), std::sqrt(1.0 - share));
  }
  return directions;
}

}  // namespace

SmoothSkin::SmoothSkin(const TetMesh& mesh) : faces_(mesh.faces) {
  group_corners(mesh);
  cut_faces();
  measure_openness(mesh);
}

// Faces that meet at a node share a normal where each turns little from the first of them.
void SmoothSkin::group_corners(const TetMesh& mesh) {
  struct Group {
    Eigen::Vector3d normal;
    int number;
  };
  std::vector<std::vector<Group>> groups(static_cast<std::size_t>(mesh.node_count()));
  normals_.resize(faces_.rows(), faces_.cols());
  for (Eigen::Index face = 0; face < faces_.cols(); ++face) {
    const Eigen::Matrix3Xd own = face_normals(nodes_of(mesh.nodes_m, faces_, face)).colwise().normalized();
    for (Eigen::Index k = 0; k < faces_.rows(); ++k) {
      std::vector<Group>& here = groups[static_cast<std::size_t>(faces_(k, face))];
      const Eigen::Vector3d normal = own.col(k);
      auto group = here.begin();
      while (group != here.end() && group->normal.dot(normal) < kCrease) ++group;
      if (group == here.end()) group = here.insert(here.end(), {normal, normal_count_++});
      normals_(k, face) = group->number;
    }
  }
}

void SmoothSkin::cut_faces() {
  const auto corner = [this](Eigen::Index k, Eigen::Index face) { return Corner{faces_(k, face), normals_(k, face)}; };
  for (Eigen::Index face = 0; face < faces_.cols(); ++face) {
    const int number = static_cast<int>(face);
    if (faces_.rows() == 3) {
      triangles_.push_back({{corner(0, face), corner(1, face), corner(2, face)}, number});
      continue;
    }
    for (const auto& q : kFaceQuarters)
      triangles_.push_back({{corner(q[0], face), corner(q[1], face), corner(q[2], face)}, number});
  }
}

Eigen::Matrix3Xd SmoothSkin::normals(const Eigen::Matrix3Xd& positions_m) const {
  Eigen::Matrix3Xd sums = Eigen::Matrix3Xd::Zero(3, normal_count_);
  for (Eigen::Index face = 0; face < faces_.cols(); ++face) {
    const Eigen::Matrix3Xd own = face_normals(nodes_of(positions_m, faces_, face));
    for (Eigen::Index k = 0; k < faces_.rows(); ++k) sums.col(normals_(k, face)) += own.col(k);
  }
  sums.colwise().normalize();
  return sums;
}

void SmoothSkin::measure_openness(const TetMesh& mesh) {
  Eigen::Matrix3Xi triangles(3, static_cast<Eigen::Index>(triangles_.size()));
  Eigen::VectorXi node_of(normal_count_);
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Corner& corner = triangles_[t].corners[static_cast<std::size_t>(k)];
      triangles(k, static_cast<Eigen::Index>(t)) = corner.node;
      node_of[corner.normal] = corner.node;
    }
  const MeshTree tree(mesh.nodes_m, triangles, MeshTree::Use::still);
  const double size_m = (mesh.nodes_m.rowwise().maxCoeff() - mesh.nodes_m.rowwise().minCoeff()).norm();
  const Eigen::Matrix3Xd outward = normals(mesh.nodes_m);
  const std::vector<Eigen::Vector3d> directions = rays();
  openness_.resize(normal_count_);
  for (int n = 0; n < normal_count_; ++n) {
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), outward.col(n));
    const Eigen::Vector3d from_m = mesh.nodes_m.col(node_of[n]) + 1e-3 * size_m * outward.col(n);
    double open = 0.0;
    for (const Eigen::Vector3d& direction : directions) {
      const Eigen::Vector3d ray_m = kReach * size_m * (turn * direction);
      const MeshHit hit = tree.cast(from_m.cast<float>(), ray_m.cast<float>());
      open += hit.triangle < 0 || hit.depth > 1.0f ? 1.0 : static_cast<double>(hit.depth);
    }
    openness_[n] = std::max(open, 0.5) / kRays;
  }
}

}  // namespace soft_robot_lab
