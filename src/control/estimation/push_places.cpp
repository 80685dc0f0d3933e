// SPDX-License-Identifier: BSD-3-Clause
#include "push_places.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include "mechanics/mesh/shape_functions.h"

namespace soft_robot_lab {
namespace {

Eigen::Matrix3d corners_of(const TetMesh& mesh, Eigen::Index face) {
  Eigen::Matrix3d corners_m;
  for (int i = 0; i < 3; ++i) corners_m.col(i) = mesh.nodes_m.col(mesh.faces(i, face));
  return corners_m;
}

// Per face, a node by which all faces that hang together are one.
std::vector<int> pieces_of(const TetMesh& mesh) {
  std::vector<int> parent(static_cast<std::size_t>(mesh.node_count()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int node) {
    while (parent[static_cast<std::size_t>(node)] != node) {
      int& up = parent[static_cast<std::size_t>(node)];
      up = parent[static_cast<std::size_t>(up)];
      node = up;
    }
    return node;
  };
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (int i = 1; i < 3; ++i) parent[static_cast<std::size_t>(root(mesh.faces(i, face)))] = root(mesh.faces(0, face));
  std::vector<int> pieces;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) pieces.push_back(root(mesh.faces(0, face)));
  return pieces;
}

// A piece of skin whose normals point to its inside is a cavity: what it encloses counts negative.
std::vector<bool> in_cavity(const TetMesh& mesh) {
  const std::vector<int> pieces = pieces_of(mesh);
  std::vector<double> enclosed_m3(static_cast<std::size_t>(mesh.node_count()), 0.0);
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    enclosed_m3[static_cast<std::size_t>(pieces[static_cast<std::size_t>(face)])] +=
        corners_of(mesh, face).determinant() / 6.0;
  std::vector<bool> inside;
  for (const int piece : pieces) inside.push_back(enclosed_m3[static_cast<std::size_t>(piece)] < 0.0);
  return inside;
}

bool held_whole(const Body& body, Eigen::Index face) {
  bool held = true;
  for (int i = 0; i < 3; ++i) held = held && body.fixed().col(body.mesh().faces(i, face)).all();
  return held;
}

PushPlace place_on(const TetMesh& mesh, Eigen::Index face, double r, double s, double area_m2) {
  PushPlace place{face, r, s, {}, area_m2};
  const FaceShape shape = face_shape(mesh.faces.rows(), r, s);
  for (Eigen::Index i = 0; i < mesh.faces.rows(); ++i) {
    place.at.nodes.push_back(mesh.faces(i, face));
    place.at.weights.push_back(shape.values[i]);
  }
  return place;
}

}  // namespace

std::vector<PushPlace> push_places(const Body& body, double spacing_m) {
  const TetMesh& mesh = body.mesh();
  const std::vector<bool> cavity = in_cavity(mesh);
  std::vector<PushPlace> places;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    if (cavity[static_cast<std::size_t>(face)] || held_whole(body, face)) continue;
    const Eigen::Matrix3d c = corners_of(mesh, face);
    const double longest_m =
        std::sqrt(std::max({(c.col(1) - c.col(0)).squaredNorm(), (c.col(2) - c.col(1)).squaredNorm(),
                            (c.col(0) - c.col(2)).squaredNorm()}));
    const double area_m2 = 0.5 * (c.col(1) - c.col(0)).cross(c.col(2) - c.col(0)).norm();
    const int cuts = std::max(1, static_cast<int>(std::ceil(longest_m / spacing_m)));
    const double step = 1.0 / cuts, share_m2 = area_m2 * step * step;
    for (int i = 0; i < cuts; ++i)
      for (int j = 0; i + j < cuts; ++j) {
        places.push_back(place_on(mesh, face, (i + 1.0 / 3.0) * step, (j + 1.0 / 3.0) * step, share_m2));
        if (i + j + 1 < cuts)
          places.push_back(place_on(mesh, face, (i + 2.0 / 3.0) * step, (j + 2.0 / 3.0) * step, share_m2));
      }
  }
  return places;
}

Eigen::Vector3d normal_at(const TetMesh& mesh, const Eigen::Matrix3Xd& positions_m, const PushPlace& place) {
  const FaceShape shape = face_shape(mesh.faces.rows(), place.r, place.s);
  Eigen::Vector3d along_r = Eigen::Vector3d::Zero(), along_s = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < mesh.faces.rows(); ++i) {
    along_r += shape.slopes(0, i) * positions_m.col(mesh.faces(i, place.face));
    along_s += shape.slopes(1, i) * positions_m.col(mesh.faces(i, place.face));
  }
  return along_r.cross(along_s).normalized();
}

}  // namespace soft_robot_lab
