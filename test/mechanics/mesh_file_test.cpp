// SPDX-License-Identifier: BSD-3-Clause
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {
namespace {

constexpr const char* kHeader = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
constexpr const char* kNodes = "$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n50 1 1 1\n$EndNodes\n";

std::string elements(const std::string& lines) {
  const auto count = std::count(lines.begin(), lines.end(), '\n');
  return "$Elements\n" + std::to_string(count) + "\n" + lines + "$EndElements\n";
}

const std::string kTets = "7 4 2 1 1 10 20 30 40\n8 4 2 1 1 20 30 40 50\n";

std::string write(const std::string& text) {
  const std::string path = testing::TempDir() + "mesh_file_test.msh";
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

TetMesh read(const std::string& text) { return read_msh(write(text)); }

std::string refusal(const std::string& text) {
  const std::string path = write(text);
  try {
    read_msh(path);
  } catch (const std::invalid_argument& error) {
    const std::string message = error.what();
    return message.rfind(path + ":", 0) == 0 ? message.substr(path.size() + 1) : message;
  }
  return "accepted";
}

TEST(ReadMsh, ReadsElementsAndNamedSurfaces) {
  const std::string names =
      "$PhysicalNames\n3\n2 5 \"outer wall\"\n3 1 \"body\"\n2 6 \"no face has this name\"\n$EndPhysicalNames\n";
  // Both triangles are turned inward in the file; the second has a number for a name, the third none.
  const std::string faces =
      "1 2 2 5 3 10 20 30\n2 2 2 9 3 20 50 30\n3 2 2 0 3 30 40 50\n4 15 2 0 1 10\n5 1 2 0 1 10 20\n";
  const TetMesh mesh =
      read(kHeader + names + "$Comments\nfree text\n$EndComments\n" + kNodes + elements(faces + kTets));
  EXPECT_NO_THROW(check_mesh(mesh));
  EXPECT_EQ(mesh.node_count(), 5);
  EXPECT_EQ(mesh.nodes_m.col(4), Eigen::Vector3d(1, 1, 1));
  EXPECT_EQ(mesh.tets.col(1), Eigen::Vector4i(1, 2, 3, 4));
  EXPECT_EQ(mesh.surface_names, (std::vector<std::string>{"outer wall", "9"}));
  EXPECT_EQ(mesh.faces.cols(), 6);  // completed
  EXPECT_EQ(mesh.face_surface, (std::vector<int>{0, 1, -1, -1, -1, -1}));
  EXPECT_NEAR(volume(mesh), 0.5, 1e-15);
}

TEST(ReadMsh, ReadsWindowsLineEndings) {
  std::string text = kHeader + std::string(kNodes) + elements(kTets);
  for (size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.insert(at, "\r");
  EXPECT_EQ(read(text).tet_count(), 2);
}

// A curved element with a different bulge on each edge: in the wrong order it would fold or change its volume.
TEST(ReadMsh, KeepsTheNodeOrderOfQuadraticElements) {
  const std::string nodes =
      "$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0.5 0 -0.01\n6 0.52 0.52 0\n7 -0.03 0.5 0\n8 0 -0.04 0.5\n"
      "9 0 0.55 0.55\n10 0.56 0 0.56\n$EndNodes\n";
  const std::string surface = "$PhysicalNames\n1\n2 1 \"slope\"\n$EndPhysicalNames\n";
  const TetMesh mesh =
      read(kHeader + surface + nodes + elements("1 9 2 1 1 2 4 3 10 9 6\n2 11 2 1 1 1 2 3 4 5 6 7 8 9 10\n"));
  EXPECT_NO_THROW(check_mesh(mesh));
  EXPECT_TRUE(mesh.quadratic());
  EXPECT_EQ(mesh.nodes_m.col(mesh.tets(8, 0)), Eigen::Vector3d(0, 0.55, 0.55));  // edge 2 3
  EXPECT_EQ(mesh.nodes_m.col(mesh.tets(9, 0)), Eigen::Vector3d(0.56, 0, 0.56));  // edge 1 3
  ASSERT_EQ(mesh.faces.rows(), 6);
  for (int side = 0; side < 3; ++side) {  // mid-edge nodes lie near the middle of their edges
    const Eigen::Vector3d straight =
        (mesh.nodes_m.col(mesh.faces(side, 0)) + mesh.nodes_m.col(mesh.faces((side + 1) % 3, 0))) / 2;
    EXPECT_LT((mesh.nodes_m.col(mesh.faces(3 + side, 0)) - straight).norm(), 0.1);
  }
}

TEST(ReadMsh, NamesFileAndLineOfWhatIsWrong) {
  const std::string head = kHeader;
  const std::string start = head + kNodes;
  EXPECT_EQ(refusal("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"),
            "2: MSH version '4.1' is not read here, only 2.2; mesh_robot rewrites other versions");
  EXPECT_EQ(refusal("$MeshFormat\n2.2 1 8\n"), "2: binary MSH is not read here, only text; mesh_robot rewrites it");
  EXPECT_EQ(refusal("solid ascii\n"), "1: expected a section, found 'solid'");
  EXPECT_EQ(refusal("$Nodes\n0\n$EndNodes\n"), "1: expected $MeshFormat first: not an MSH file");
  EXPECT_EQ(refusal(head + "$Nodes\n2\n1 0 0 0\n1 0 0 1\n"), "7: node 1 stands twice");
  EXPECT_EQ(refusal(head + "$Nodes\n2\n1 0 0 0" + std::string(1, '\0') + "\n"), "6: '0?' is not a finite number");
  EXPECT_EQ(refusal(head + "$Nodes\n2\n1 0 0 nan\n"), "6: 'nan' is not a finite number");
  EXPECT_EQ(refusal(head + "$Nodes\n2\n1 0 0\n"), "6: '' is not a finite number");
  EXPECT_EQ(refusal(head + "$Nodes\n2\n1 0 0 0\n"), "6: the file ends too early");
  EXPECT_EQ(refusal(head + "$Nodes\n1\n1 0 0 0\n2 0 0 0\n$EndNodes\n"), "7: expected $EndNodes");
  EXPECT_EQ(refusal(head + "$Nodes\n-1\n"), "5: -1 lines announced");
  EXPECT_EQ(refusal(start + elements("1 4 2 1 1 10 20 30 99\n")), "14: there is no node 99");
  EXPECT_EQ(refusal(start + elements("1 5 2 1 1 10 20 30 40 50 10 20 30\n")),
            "14: element type 5 is not a tetrahedron of 4 or 10 nodes or a side of one");
  EXPECT_EQ(refusal(start + elements(kTets + "3 11 2 1 1 10 20 30 40 50 10 20 30 40 50\n")),
            "16: elements of 4 and of 10 nodes are mixed");
  EXPECT_EQ(refusal(start + elements("1 2 2 5 5 10 20 50\n" + kTets)), "14: this triangle is no side of an element");
  EXPECT_EQ(refusal(start + elements("1 2 2 5 5 20 30 40\n" + kTets)),
            "14: this triangle of a named surface lies inside the body");
  EXPECT_EQ(refusal(start + elements("1 2 2 5 5 10 20 30\n2 2 2 6 6 10 30 20\n" + kTets)),
            "15: this triangle stands in line 14 already");
  EXPECT_EQ(refusal(start), "11: the file holds no tetrahedra");
  EXPECT_THROW(read_msh("/no/such/file.msh"), std::invalid_argument);
}

}  // namespace
}  // namespace soft_robot_lab
