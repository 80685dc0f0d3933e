// SPDX-License-Identifier: BSD-3-Clause
#include "load_weights.h"

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/LU>

#include "shape_functions.h"

namespace soft_robot_lab {
namespace {

constexpr int kCuts = 8;            // of each side of a curved face
constexpr double kStraight = 1e-9;  // of a side: how far its mid-edge may be off its middle

// A place on a face: its coordinates on it, and in the box's space.
struct Corner {
  Eigen::Vector2d local;
  Eigen::Vector3d at_m;
};
using Polygon = std::vector<Corner>;

Eigen::Vector3d position_m(const TetMesh& mesh, Eigen::Index face, const Eigen::Vector2d& local) {
  const FaceShape shape = face_shape(mesh.faces.rows(), local.x(), local.y());
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  for (Eigen::Index a = 0; a < mesh.faces.rows(); ++a) at_m += shape.values[a] * mesh.nodes_m.col(mesh.faces(a, face));
  return at_m;
}

bool straight(const TetMesh& mesh, Eigen::Index face) {
  if (mesh.faces.rows() == 3) return true;
  for (int side = 0; side < 3; ++side) {
    const Eigen::Vector3d a = mesh.nodes_m.col(mesh.faces(side, face)),
                          b = mesh.nodes_m.col(mesh.faces((side + 1) % 3, face));
    if ((mesh.nodes_m.col(mesh.faces(3 + side, face)) - 0.5 * (a + b)).norm() > kStraight * (a - b).norm())
      return false;
  }
  return true;
}

// Where a box's sides are so near that it counts as on them.
Eigen::Vector3d snapped_m(Eigen::Vector3d at_m, const Eigen::AlignedBox3d& box, double on_side_m) {
  for (const Eigen::Vector3d& side_m : {box.min(), box.max()})
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(at_m[axis] - side_m[axis]) <= on_side_m) at_m[axis] = side_m[axis];
  return at_m;
}

// A box that is thinner than that counts as flat, so that of skin across it nothing lies inside.
Eigen::AlignedBox3d flattened(Eigen::AlignedBox3d box, double on_side_m) {
  for (int axis = 0; axis < 3; ++axis) {
    const double width_m = box.max()[axis] - box.min()[axis];
    if (width_m >= 0.0 && width_m <= 2.0 * on_side_m)
      box.min()[axis] = box.max()[axis] = 0.5 * (box.min()[axis] + box.max()[axis]);
  }
  return box;
}

// The part on the inner side of one of the box's sides (Sutherland & Hodgman 1974).
Polygon cut(const Polygon& polygon, int axis, double side_m, double inwards) {
  Polygon part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double from_m = inwards * (from.at_m[axis] - side_m), to_m = inwards * (to.at_m[axis] - side_m);
    if (from_m >= 0.0) part.push_back(from);
    if ((from_m > 0.0 && to_m < 0.0) || (from_m < 0.0 && to_m > 0.0)) {
      const double share = from_m / (from_m - to_m);
      part.push_back({from.local + share * (to.local - from.local), from.at_m + share * (to.at_m - from.at_m)});
      part.back().at_m[axis] = side_m;
    }
  }
  return part;
}

Polygon part_in(Polygon polygon, const Eigen::AlignedBox3d& box) {
  for (int axis = 0; axis < 3 && polygon.size() > 2; ++axis) {
    polygon = cut(polygon, axis, box.min()[axis], 1.0);
    polygon = cut(polygon, axis, box.max()[axis], -1.0);
  }
  return polygon;
}

// By the six-point rule of degree 4 (Dunavant 1985).
void add_triangle(const TetMesh& mesh, Eigen::Index face, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                  const Eigen::Vector2d& c, Eigen::VectorXd& weights_m2) {
  constexpr double kPoints[6][3] = {{0.445948490915965, 0.445948490915965, 0.223381589678011},
                                    {0.445948490915965, 0.108103018168070, 0.223381589678011},
                                    {0.108103018168070, 0.445948490915965, 0.223381589678011},
                                    {0.091576213509771, 0.091576213509771, 0.109951743655322},
                                    {0.091576213509771, 0.816847572980459, 0.109951743655322},
                                    {0.816847572980459, 0.091576213509771, 0.109951743655322}};
  const Eigen::Vector2d ab = b - a, ac = c - a;
  const double twice_area = std::abs(ab.x() * ac.y() - ab.y() * ac.x());
  for (const auto& point : kPoints) {
    const Eigen::Vector2d local = a + point[0] * ab + point[1] * ac;
    const FaceShape shape = face_shape(mesh.faces.rows(), local.x(), local.y());
    Eigen::Vector3d along_r = Eigen::Vector3d::Zero(), along_s = Eigen::Vector3d::Zero();
    for (Eigen::Index n = 0; n < mesh.faces.rows(); ++n) {
      along_r += shape.slopes(0, n) * mesh.nodes_m.col(mesh.faces(n, face));
      along_s += shape.slopes(1, n) * mesh.nodes_m.col(mesh.faces(n, face));
    }
    weights_m2 += 0.5 * twice_area * point[2] * along_r.cross(along_s).norm() * shape.values;
  }
}

// The face as `cuts`^2 triangles that are alike.
std::vector<std::array<Eigen::Vector2d, 3>> pieces(int cuts) {
  std::vector<std::array<Eigen::Vector2d, 3>> all;
  const auto at = [&](int i, int k) {
    return Eigen::Vector2d(static_cast<double>(i) / cuts, static_cast<double>(k) / cuts);
  };
  for (int i = 0; i < cuts; ++i) {
    for (int k = 0; i + k < cuts; ++k) {
      all.push_back({at(i, k), at(i + 1, k), at(i, k + 1)});
      if (i + k + 1 < cuts) all.push_back({at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  return all;
}

// Around all of a face: its Bezier points.
Eigen::AlignedBox3d box_around(const TetMesh& mesh, Eigen::Index face) {
  Eigen::AlignedBox3d box;
  for (int corner = 0; corner < 3; ++corner) box.extend(mesh.nodes_m.col(mesh.faces(corner, face)));
  if (mesh.faces.rows() == 3) return box;
  for (int side = 0; side < 3; ++side)
    box.extend(Eigen::Vector3d(2.0 * mesh.nodes_m.col(mesh.faces(3 + side, face)) -
                               0.5 * mesh.nodes_m.col(mesh.faces(side, face)) -
                               0.5 * mesh.nodes_m.col(mesh.faces((side + 1) % 3, face))));
  return box;
}

}  // namespace

double rest_volume_m3(const TetMesh& mesh, int element) {
  double sum_m3 = 0.0;
  for (const Eigen::Vector3d& point : tet_quadrature_points()) {
    const ShapeFunctions shape = shape_functions(static_cast<int>(mesh.tets.rows()), point);
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
    for (Eigen::Index a = 0; a < mesh.tets.rows(); ++a)
      jacobian += mesh.nodes_m.col(mesh.tets(a, element)) * shape.gradients.col(a).transpose();
    sum_m3 += jacobian.determinant() / 24.0;
  }
  return sum_m3;
}

Eigen::VectorXd face_weights_m2(const TetMesh& mesh, Eigen::Index face, const Eigen::AlignedBox3d& asked,
                                double on_side_m) {
  const Eigen::AlignedBox3d box = flattened(asked, on_side_m);
  Eigen::VectorXd weights_m2 = Eigen::VectorXd::Zero(mesh.faces.rows());
  const Eigen::AlignedBox3d around = box_around(mesh, face);
  const Eigen::Vector3d slack_m = Eigen::Vector3d::Constant(on_side_m);
  const Eigen::AlignedBox3d larger(box.min() - slack_m, box.max() + slack_m);
  if (!larger.intersects(around)) return weights_m2;
  const bool whole = straight(mesh, face) || larger.contains(around);
  for (const std::array<Eigen::Vector2d, 3>& piece : pieces(whole ? 1 : kCuts)) {
    Polygon polygon;
    for (const Eigen::Vector2d& local : piece)
      polygon.push_back({local, snapped_m(position_m(mesh, face, local), box, on_side_m)});
    polygon = part_in(std::move(polygon), box);
    for (std::size_t i = 2; i < polygon.size(); ++i)
      add_triangle(mesh, face, polygon[0].local, polygon[i - 1].local, polygon[i].local, weights_m2);
  }
  return weights_m2;
}

}  // namespace soft_robot_lab
