// SPDX-License-Identifier: BSD-3-Clause
#include "session/report/smooth_skin.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "mechanics/box_mesh.h"

namespace soft_robot_lab {
namespace {

TetMesh cube(int cells = 4, bool quadratic = true) {
  TetMesh mesh = box_mesh({-1, -1, -1}, {1, 1, 1}, {cells, cells, cells}, quadratic);
  complete_boundary(mesh);
  return mesh;
}

// The cube's skin as a sphere.
Eigen::Matrix3Xd on_sphere(const TetMesh& mesh) { return mesh.nodes_m.colwise().normalized(); }

TEST(SmoothSkin, KeepsTheEdgesOfACubeSharp) {
  const TetMesh mesh = cube();
  const SmoothSkin skin(mesh);
  const Eigen::Matrix3Xd normals = skin.normals(mesh.nodes_m);
  for (const Eigen::Vector3d& normal : normals.colwise()) EXPECT_NEAR(normal.cwiseAbs().maxCoeff(), 1.0, 1e-12);
  EXPECT_EQ(skin.triangles().size(), 4u * 6u * 4u * 4u * 2u);
}

TEST(SmoothSkin, HasTheNormalsOfASphere) {
  TetMesh mesh = cube();
  mesh.nodes_m = on_sphere(mesh);
  const SmoothSkin skin(mesh);
  const Eigen::Matrix3Xd normals = skin.normals(mesh.nodes_m);
  double worst = 1.0;
  for (const auto& triangle : skin.triangles())
    for (const auto& corner : triangle.corners)
      worst = std::min(worst, normals.col(corner.normal).dot(mesh.nodes_m.col(corner.node)));
  EXPECT_GT(worst, std::cos(3.0 * M_PI / 180.0));
}

TEST(SmoothSkin, TurnsNormalsWithTheBody) {
  const TetMesh mesh = cube();
  const SmoothSkin skin(mesh);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_TRUE(skin.normals(turn * mesh.nodes_m).isApprox(turn * skin.normals(mesh.nodes_m), 1e-12));
}

TEST(SmoothSkin, IsOpenOutsideAndDarkInACavity) {
  TetMesh mesh = cube();
  EXPECT_EQ(SmoothSkin(mesh).openness().minCoeff(), 1.0);
  mesh.faces.row(1).swap(mesh.faces.row(2));  // as seen from within
  mesh.faces.row(3).swap(mesh.faces.row(5));
  EXPECT_LT(SmoothSkin(mesh).openness().maxCoeff(), 0.999);
}

TEST(SmoothSkin, TakesLinearFacesWhole) {
  const SmoothSkin skin(cube(2, false));
  EXPECT_EQ(skin.triangles().size(), 6u * 2u * 2u * 2u);
}

}  // namespace
}  // namespace soft_robot_lab
