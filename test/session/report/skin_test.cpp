// SPDX-License-Identifier: BSD-3-Clause
#include "session/report/skin.h"

#include <map>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

TetMesh tetrahedron() {
  TetMesh mesh;
  mesh.nodes_m.resize(3, 4);
  mesh.nodes_m << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.tets = Eigen::Vector4i(0, 1, 2, 3);
  complete_boundary(mesh);
  return mesh;
}

double enclosed_m3(const Eigen::Matrix3Xi& triangles, const Eigen::Matrix3Xd& vertices_m) {
  double sum = 0;
  for (const auto& t : triangles.colwise())
    sum += vertices_m.col(t[0]).dot(vertices_m.col(t[1]).cross(vertices_m.col(t[2]))) / 6;
  return sum;
}

TEST(Skin, IsClosedAndTurnedOutward) {
  const TetMesh mesh = make_quadratic(tetrahedron());
  const Skin skin(mesh, 4);
  EXPECT_EQ(skin.triangles().cols(), 4 * 16);
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : skin.triangles().colwise())
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  EXPECT_NEAR(enclosed_m3(skin.triangles(), skin.vertices_m(mesh.nodes_m)), 1.0 / 6, 1e-12);
}

TEST(Skin, FollowsTheCurveOfQuadraticFaces) {
  const TetMesh mesh = make_quadratic(tetrahedron());
  const auto bend = [](const Eigen::Vector3d& p) { return Eigen::Vector3d(p.x(), p.y(), p.z() + 0.3 * p.x() * p.y()); };
  Eigen::Matrix3Xd bent_m = mesh.nodes_m;
  for (Eigen::Index i = 0; i < bent_m.cols(); ++i) bent_m.col(i) = bend(mesh.nodes_m.col(i));
  const Skin skin(mesh);
  const Eigen::Matrix3Xd rest_m = skin.vertices_m(mesh.nodes_m), vertices_m = skin.vertices_m(bent_m);
  for (Eigen::Index i = 0; i < rest_m.cols(); ++i)
    EXPECT_LT((vertices_m.col(i) - bend(rest_m.col(i))).norm(), 1e-14);  // the bend is quadratic, as the faces are
}

TEST(Skin, LeavesFlatFacesWhole) { EXPECT_EQ(Skin(tetrahedron()).triangles().cols(), 4); }

TEST(Skin, LeavesOutCavities) {
  TetMesh mesh = tetrahedron();
  mesh.nodes_m.conservativeResize(3, 8);
  mesh.nodes_m.rightCols(4) = (0.1 * mesh.nodes_m.leftCols(4)).array() + 0.1;
  mesh.faces.conservativeResize(3, 8);
  mesh.faces.rightCols(4) = mesh.faces.leftCols(4).array() + 4;
  mesh.faces.rightCols(4).row(0).swap(mesh.faces.rightCols(4).row(1));  // it bounds what is around it
  EXPECT_EQ(outer_faces(mesh), (std::vector<int>{0, 1, 2, 3}));
}

TEST(Skin, RefusesAbsurdCuts) {
  EXPECT_THROW(Skin(tetrahedron(), 0), std::invalid_argument);
  EXPECT_THROW(Skin(tetrahedron(), 65), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
