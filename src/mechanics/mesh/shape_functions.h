// SPDX-License-Identifier: BSD-3-Clause
// Shape functions of 4- and 10-node tetrahedra, and of their faces, in reference coordinates (r, s, t) = weights of
// corners 1, 2, 3. Node order as in TetMesh.
#pragma once

#include <array>

#include <Eigen/Core>

namespace soft_robot_lab {

// The two corners between which mid-edge node 4 + i lies.
inline constexpr std::array<std::array<int, 2>, 6> kTetEdges{{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}}};

struct ShapeFunctions {
  Eigen::VectorXd values;                              // per node
  Eigen::Matrix<double, 3, Eigen::Dynamic> gradients;  // d/d(r, s, t), 3 x nodes
};

inline ShapeFunctions shape_functions(int node_count, const Eigen::Vector3d& local) {
  const Eigen::Vector4d l(1.0 - local.sum(), local.x(), local.y(), local.z());
  Eigen::Matrix<double, 3, 4> dl;
  dl << -1, 1, 0, 0, -1, 0, 1, 0, -1, 0, 0, 1;
  ShapeFunctions shape{Eigen::VectorXd(node_count), Eigen::Matrix<double, 3, Eigen::Dynamic>(3, node_count)};
  if (node_count == 4) {
    shape.values = l;
    shape.gradients = dl;
    return shape;
  }
  for (int i = 0; i < 4; ++i) {
    shape.values[i] = l[i] * (2.0 * l[i] - 1.0);
    shape.gradients.col(i) = (4.0 * l[i] - 1.0) * dl.col(i);
  }
  for (int e = 0; e < 6; ++e) {
    const int a = kTetEdges[e][0], b = kTetEdges[e][1];
    shape.values[4 + e] = 4.0 * l[a] * l[b];
    shape.gradients.col(4 + e) = 4.0 * (l[a] * dl.col(b) + l[b] * dl.col(a));
  }
  return shape;
}

// Of a face with 3 or 6 nodes, in (r, s) = weights of corners 1, 2.
struct FaceShape {
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1> values;  // per node
  Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, 6> slopes;  // d/d(r, s), 2 x nodes
};

inline FaceShape face_shape(Eigen::Index node_count, double r, double s) {
  const double l = 1.0 - r - s;
  FaceShape shape;
  shape.values.resize(node_count);
  shape.slopes.resize(2, node_count);
  if (node_count == 6) {
    shape.values << l * (2 * l - 1), r * (2 * r - 1), s * (2 * s - 1), 4 * l * r, 4 * r * s, 4 * s * l;
    shape.slopes << 1 - 4 * l, 4 * r - 1, 0, 4 * (l - r), 4 * s, -4 * s,  //
        1 - 4 * l, 0, 4 * s - 1, -4 * r, 4 * r, 4 * (l - s);
  } else {
    shape.values << l, r, s;
    shape.slopes << -1, 1, 0, -1, 0, 1;
  }
  return shape;
}

// Second derivatives of the same, nodes x 3: d2/dr2, d2/ds2, d2/(dr ds). They are the same all over the face.
inline Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 6, 3> face_bends(Eigen::Index node_count) {
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 6, 3> bends;
  bends.setZero(node_count, 3);
  if (node_count != 6) return bends;
  bends.col(0) << 4, 4, 0, -8, 0, 0;
  bends.col(1) << 4, 0, 4, 0, 0, -8;
  bends.col(2) << 4, 0, 0, -4, 4, -4;
  return bends;
}

// A face with 6 nodes as four triangles:
//         2
//        / \          .
//       5---4
//      / \ / \        .
//     0---3---1
inline constexpr std::array<std::array<int, 3>, 4> kFaceQuarters{{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};

// Four points, weight 1/24 each, exact for quadratics.
inline std::array<Eigen::Vector3d, 4> tet_quadrature_points() {
  constexpr double a = 0.58541019662496845446, b = 0.13819660112501051518;
  return {Eigen::Vector3d(b, b, b), Eigen::Vector3d(a, b, b), Eigen::Vector3d(b, a, b), Eigen::Vector3d(b, b, a)};
}

}  // namespace soft_robot_lab
