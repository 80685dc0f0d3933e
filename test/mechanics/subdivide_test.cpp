// SPDX-License-Identifier: BSD-3-Clause
#include "mechanics/mesh/subdivide.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "box_mesh.h"

namespace soft_robot_lab {
namespace {

TetMesh bar(bool quadratic) {
  TetMesh mesh = box_mesh({0, 0, 0}, {0.1, 0.02, 0.03}, {3, 1, 2}, quadratic);
  complete_boundary(mesh);
  mesh.surface_names = {"left", "rest"};
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    const bool left = mesh.nodes_m(0, mesh.faces(0, face)) + mesh.nodes_m(0, mesh.faces(1, face)) +
                          mesh.nodes_m(0, mesh.faces(2, face)) ==
                      0.0;
    mesh.face_surface[static_cast<size_t>(face)] = left ? 0 : 1;
  }
  return mesh;
}

// Bent to a quarter of a ring, so that edges and faces are curved.
TetMesh bent(TetMesh mesh) {
  for (auto node : mesh.nodes_m.colwise()) {
    const double angle = node.x() / 0.06, radius = 0.06 - node.y();
    node << radius * std::sin(angle), 0.06 - radius * std::cos(angle), node.z();
  }
  return mesh;
}

class Subdivide : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Element, Subdivide, testing::Bool(),
                         [](const auto& element) { return element.param ? "quadratic" : "linear"; });

TEST_P(Subdivide, CutsEveryElementIntoEightAndEveryFaceIntoFour) {
  const TetMesh coarse = bar(GetParam());
  const TetMesh fine = subdivide(coarse).mesh;
  EXPECT_EQ(fine.tets.rows(), coarse.tets.rows());
  EXPECT_EQ(fine.tet_count(), 8 * coarse.tet_count());
  EXPECT_EQ(fine.faces.cols(), 4 * coarse.faces.cols());
  EXPECT_EQ(fine.surface_names, coarse.surface_names);
  const TetMesh same = box_mesh({0, 0, 0}, {0.1, 0.02, 0.03}, {6, 2, 4}, GetParam());
  EXPECT_EQ(fine.node_count(), same.node_count());
  EXPECT_EQ(fine.nodes_m.leftCols(coarse.node_count()), coarse.nodes_m);
}

TEST_P(Subdivide, GivesAMeshWithoutGapsThatFillsTheSameBody) {
  const TetMesh coarse = bent(bar(GetParam()));
  const TetMesh fine = subdivide(coarse).mesh;
  EXPECT_NO_THROW(check_mesh(fine));
  EXPECT_NEAR(volume(fine), volume(coarse), 1e-12 * volume(coarse));
  TetMesh again = fine;
  complete_boundary(again);  // a gap would show as faces that were not listed
  EXPECT_EQ(again.faces.cols(), fine.faces.cols());
}

TEST_P(Subdivide, KeepsTheNamesOfSurfaces) {
  const TetMesh coarse = bar(GetParam());
  const TetMesh fine = subdivide(coarse).mesh;
  int left = 0;
  for (Eigen::Index face = 0; face < fine.faces.cols(); ++face) {
    if (fine.face_surface[static_cast<size_t>(face)] != 0) continue;
    ++left;
    for (Eigen::Index i = 0; i < fine.faces.rows(); ++i) EXPECT_EQ(fine.nodes_m(0, fine.faces(i, face)), 0.0);
  }
  EXPECT_EQ(left, 4 * std::count(coarse.face_surface.begin(), coarse.face_surface.end(), 0));
}

TEST_P(Subdivide, CarriesWhatTheCoarseElementsInterpolate) {
  const TetMesh coarse = bar(GetParam());
  const Subdivision fine = subdivide(coarse);
  const auto field = [](const Eigen::Matrix3Xd& nodes) {  // linear, and quadratic where the elements are
    Eigen::Matrix3Xd values = 3.0 * nodes;
    if (GetParam()) values.row(1) += (nodes.row(0).array() * nodes.row(2).array()).matrix();
    return values;
  };
  EXPECT_LT((fine.carry(field(coarse.nodes_m)) - field(fine.mesh.nodes_m)).norm(), 1e-14);
}

}  // namespace
}  // namespace soft_robot_lab
