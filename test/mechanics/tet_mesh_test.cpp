// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/tet_mesh.h"

#include <cmath>
#include <functional>
#include <stdexcept>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace soft_robot_lab {
namespace {

TetMesh one_tet() {
  TetMesh mesh;
  mesh.nodes_m.resize(3, 4);
  mesh.nodes_m << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.tets.resize(4, 1);
  mesh.tets << 0, 1, 2, 3;
  mesh.faces.resize(3, 0);
  return mesh;
}

// Two elements on either side of the triangle 1 2 3.
TetMesh two_tets() {
  TetMesh mesh = one_tet();
  mesh.nodes_m.conservativeResize(3, 5);
  mesh.nodes_m.col(4) << 1, 1, 1;
  mesh.tets.resize(4, 2);
  mesh.tets << 0, 1, 1, 2, 2, 3, 3, 4;
  return mesh;
}

std::string refusal(const TetMesh& mesh) {
  try {
    check_mesh(mesh);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// The volume that the faces enclose (divergence theorem), with curved faces cut into many flat triangles.
double enclosed_volume(const TetMesh& mesh) {
  constexpr int n = 40;
  double sum = 0;
  for (int face = 0; face < mesh.faces.cols(); ++face) {
    const auto at = [&](int i, int j) -> Eigen::Vector3d {
      const double b = double(i) / n, c = double(j) / n, a = 1 - b - c;
      const auto x = [&](int node) { return mesh.nodes_m.col(mesh.faces(node, face)); };
      if (mesh.faces.rows() == 3) return a * x(0) + b * x(1) + c * x(2);
      return a * (2 * a - 1) * x(0) + b * (2 * b - 1) * x(1) + c * (2 * c - 1) * x(2) + 4 * a * b * x(3) +
             4 * b * c * x(4) + 4 * c * a * x(5);
    };
    const auto add = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& r) {
      sum += p.dot(q.cross(r)) / 6;
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        add(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < n) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
    }
  }
  return sum;
}

TEST(TetMesh, MeasuresTheVolumeOfFlatElements) {
  EXPECT_NEAR(volume(one_tet()), 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(volume(make_quadratic(one_tet())), 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(volume(two_tets()), 1.0 / 6.0 + 1.0 / 3.0, 1e-15);
}

TEST(TetMesh, MeasuresTheVolumeOfCurvedElementsExactly) {
  TetMesh mesh = make_quadratic(two_tets());
  // One mid-edge node after the other is moved, so that a wrong node order cannot hide.
  for (int node = 5; node < mesh.node_count(); ++node) {
    mesh.nodes_m.col(node) += Eigen::Vector3d(0.03 * (node - 7), 0.02 * (8 - node), 0.05 * std::sin(node));
    mesh.faces.resize(6, 0);
    mesh.face_surface.clear();
    complete_boundary(mesh);
    EXPECT_NEAR(enclosed_volume(mesh), volume(mesh), 2e-4 * volume(mesh)) << node;
    EXPECT_EQ(refusal(mesh), "accepted") << node;
  }
}

TEST(TetMesh, CompletesTheBoundaryOutward) {
  TetMesh mesh = two_tets();
  complete_boundary(mesh);
  EXPECT_EQ(mesh.faces.cols(), 6);
  EXPECT_EQ(mesh.face_surface, std::vector<int>(6, -1));
  EXPECT_NEAR(enclosed_volume(mesh), volume(mesh), 1e-12);
  EXPECT_EQ(refusal(mesh), "accepted");
}

TEST(TetMesh, KeepsNamedFacesWhenTheBoundaryIsCompleted) {
  TetMesh mesh = two_tets();
  mesh.faces.resize(3, 1);
  mesh.faces << 0, 2, 1;
  mesh.face_surface = {0};
  mesh.surface_names = {"floor"};
  complete_boundary(mesh);
  EXPECT_EQ(mesh.faces.cols(), 6);
  EXPECT_EQ(mesh.face_surface[0], 0);
  EXPECT_EQ(mesh.faces.col(0), Eigen::Vector3i(0, 2, 1));
  complete_boundary(mesh);
  EXPECT_EQ(mesh.faces.cols(), 6);
}

TEST(TetMesh, BecomesQuadraticAndLinearAgain) {
  TetMesh mesh = two_tets();
  mesh.faces.resize(3, 1);
  mesh.faces << 0, 2, 1;
  mesh.face_surface = {0};
  mesh.surface_names = {"floor"};
  const TetMesh quadratic = make_quadratic(mesh);
  EXPECT_EQ(quadratic.node_count(), 5 + 9);  // edges of two elements with a common face
  EXPECT_EQ(refusal(quadratic), "accepted");
  const TetMesh linear = make_linear(quadratic);
  EXPECT_EQ(linear.nodes_m, mesh.nodes_m);
  EXPECT_EQ(linear.tets, mesh.tets);
  EXPECT_EQ(linear.faces, mesh.faces);
  EXPECT_EQ(linear.surface_names, mesh.surface_names);
  EXPECT_EQ(refusal(linear), "accepted");
}

TEST(TetMesh, DropsMidNodesWhereverTheyStand) {
  TetMesh mesh = make_quadratic(one_tet());
  mesh.nodes_m = mesh.nodes_m.rowwise().reverse().eval();
  mesh.tets = mesh.tets.unaryExpr([](int node) { return 9 - node; }).eval();
  const TetMesh linear = make_linear(mesh);
  EXPECT_EQ(linear.node_count(), 4);
  EXPECT_EQ(refusal(linear), "accepted");
  EXPECT_NEAR(volume(linear), 1.0 / 6.0, 1e-15);
}

TEST(CheckMesh, RefusesMeshesThatAreNotWhole) {
  const std::vector<std::pair<std::string, std::function<void(TetMesh&)>>> faults = {
      {"no element", [](TetMesh& m) { m.tets.resize(4, 0); }},
      {"elements have 5 nodes", [](TetMesh& m) { m.tets = Eigen::MatrixXi::Zero(5, 1); }},
      {"element 1: node 5 is out of range [0, 5)", [](TetMesh& m) { m.tets(2, 1) = 5; }},
      {"element 0: node -1 is out of range", [](TetMesh& m) { m.tets(0, 0) = -1; }},
      {"node 5 at (7, 0, 0) m belongs to no element",
       [](TetMesh& m) {
         m.nodes_m.conservativeResize(3, 6);
         m.nodes_m.col(5) << 7, 0, 0;
       }},
      {"is not finite", [](TetMesh& m) { m.nodes_m(1, 2) = std::nan(""); }},
      {"element 1 at (0.5, 0.5, 0.5) m with signed volume -0.333333 m^3 is inverted",
       [](TetMesh& m) { std::swap(m.tets(0, 1), m.tets(1, 1)); }},
      {"element 1 at (0.375, 0.375, 0.25) m with signed volume 0 m^3 is degenerate",
       [](TetMesh& m) { m.nodes_m.col(4) << 0.5, 0.5, 0; }},
      {"degenerate", [](TetMesh& m) { m.tets(0, 1) = m.tets(3, 1); }},
      {"node 3 at (0, 0, 1e+300) m lies out of range [-1e+06, 1e+06] m", [](TetMesh& m) { m.nodes_m(2, 3) = 1e300; }},
      {"it is 1e-10 m large, out of range [1e-09, 2e+06] m: its numbers are metres, unless a `scale` beside it says",
       [](TetMesh& m) { m.nodes_m *= 1e-10; }},
      {"it is 1e-300 m large", [](TetMesh& m) { m.nodes_m *= 1e-300; }},
      {"element 0 at (0.25, 0.25, 0.25) m with signed volume 0.166667 m^3 and element 1 at (0, 0, 0) m with signed "
       "volume 0.666667 m^3 lie on the same side of the face that they share: one is folded over the other",
       [](TetMesh& m) {
         m.nodes_m.col(4).setConstant(-1.0);
         std::swap(m.tets(0, 1), m.tets(1, 1));
       }},
      {"falls into 2 parts",
       [](TetMesh& m) {
         m.nodes_m.conservativeResize(3, 8);
         m.nodes_m.rightCols(4) = m.nodes_m.leftCols(4).array() + 2.0;
         m.nodes_m.col(4).setConstant(3.0);
         m.tets.col(1) << 5, 6, 7, 4;
       }},
      {"more than two elements share a face",
       [](TetMesh& m) {
         m.tets.conservativeResize(4, 3);
         m.tets.col(2) = m.tets.col(1);
       }},
      {"face 0 at", [](TetMesh& m) { m.faces.col(0).reverseInPlace(); }},
      {"does not lie on the boundary", [](TetMesh& m) { m.faces.col(0) << 1, 2, 3; }},
      {"listed twice", [](TetMesh& m) { m.faces.col(0) = m.faces.col(1); }},
      {"face 2: node 9 is out of range", [](TetMesh& m) { m.faces(1, 2) = 9; }},
      {"face_surface 0 is out of range", [](TetMesh& m) { m.face_surface[0] = 0; }},
      {"one entry for each face", [](TetMesh& m) { m.face_surface.pop_back(); }},
      {"faces have 6 nodes", [](TetMesh& m) { m.faces = Eigen::MatrixXi::Zero(6, 6); }},
  };
  for (const auto& [message, damage] : faults) {
    TetMesh mesh = two_tets();
    complete_boundary(mesh);
    damage(mesh);
    EXPECT_TRUE(contains(refusal(mesh), message)) << refusal(mesh) << "\nwanted: " << message;
  }
}

// Its sides meet two by two.
TEST(CheckMesh, RefusesAnElementThatStandsTwice) {
  TetMesh mesh = one_tet();
  mesh.tets.conservativeResize(4, 2);
  mesh.tets.col(1) << mesh.tets(1, 0), mesh.tets(2, 0), mesh.tets(0, 0), mesh.tets(3, 0);
  complete_boundary(mesh);
  EXPECT_TRUE(contains(refusal(mesh), "has the corners of element 0")) << refusal(mesh);
}

TEST(CheckMesh, FindsAFoldedElementOfPositiveVolume) {
  TetMesh mesh = make_quadratic(one_tet());
  mesh.nodes_m.col(4) =
      0.2 * mesh.nodes_m.col(0) + 0.8 * mesh.nodes_m.col(1);  // past the quarter point: folds a corner
  EXPECT_GT(volume(mesh), 0.0);
  EXPECT_TRUE(contains(refusal(mesh), "is inverted")) << refusal(mesh);
}

TEST(CheckMesh, JudgesFlatnessRelativeToSize) {
  TetMesh mesh = two_tets();
  mesh.nodes_m *= 1e-6;
  EXPECT_EQ(refusal(mesh), "accepted");
  mesh.nodes_m *= 1e12;
  EXPECT_EQ(refusal(mesh), "accepted");
}

TEST(CheckMesh, RefusesPartsThatMeetInAnEdgeOnly) {
  TetMesh mesh = one_tet();
  mesh.nodes_m.conservativeResize(3, 6);
  mesh.nodes_m.col(4) << -1, 0, 0;
  mesh.nodes_m.col(5) << 0, -1, 0;
  mesh.tets.conservativeResize(4, 2);
  mesh.tets.col(1) << 0, 4, 5, 3;
  EXPECT_TRUE(contains(refusal(mesh), "without a common face")) << refusal(mesh);
}

}  // namespace
}  // namespace soft_robot_lab
