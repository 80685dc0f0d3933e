// SPDX-License-Identifier: BSD-3-Clause
#include "import_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "convert_mesh.h"
#include "mechanics/mesh/tet_faces.h"

namespace soft_robot_lab {
namespace {

constexpr double kSamePlace = 1e-6;  // of the body's size

// Sets that grow together, of the numbers below a count.
class Sets {
 public:
  explicit Sets(Eigen::Index count) : parent_(static_cast<size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int root(int one) {
    while (at(one) != one) one = at(one) = at(at(one));
    return one;
  }
  void unite(int one, int other) { at(root(one)) = root(other); }

 private:
  int& at(int i) { return parent_[static_cast<size_t>(i)]; }
  std::vector<int> parent_;
};

double corner_volume(const TetMesh& mesh, int tet) {
  const auto edge = [&](int corner) -> Eigen::Vector3d {
    return mesh.nodes_m.col(mesh.tets(corner, tet)) - mesh.nodes_m.col(mesh.tets(0, tet));
  };
  return edge(1).cross(edge(2)).dot(edge(3)) / 6;
}

int turn_elements(TetMesh& mesh) {
  constexpr int exchanged[10] = {0, 2, 1, 3, 6, 5, 4, 7, 9, 8};  // corners 1 and 2, and the middles that go with them
  int turned = 0;
  for (int tet = 0; tet < mesh.tet_count(); ++tet) {
    if (corner_volume(mesh, tet) >= 0) continue;
    const Eigen::VectorXi before = mesh.tets.col(tet);
    for (Eigen::Index i = 0; i < before.size(); ++i) mesh.tets(i, tet) = before[exchanged[i]];
    ++turned;
  }
  return turned;
}

// Nodes by the cell of a grid that they lie in; its cells are as large as what still counts as one place.
class NodeGrid {
 public:
  NodeGrid(const Eigen::Matrix3Xd& nodes_m, double cell_m) : nodes_m_(nodes_m), cell_m_(cell_m) {
    for (int node = 0; node < static_cast<int>(nodes_m.cols()); ++node) cells_[cell_of(node)].push_back(node);
  }

  // Nodes that may lie as near.
  template <typename Take>
  void visit_near(int node, const Take& take) const {
    const Cell middle = cell_of(node);
    for (std::int64_t i = 0; i < 27; ++i) {
      const auto found = cells_.find({middle[0] + i % 3 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i / 9 - 1});
      if (found == cells_.end()) continue;
      for (const int other : found->second) take(other);
    }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const {
      std::uint64_t hash = 0;
      for (const std::int64_t part : cell) hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9e3779b97f4a7c15u;
      return hash ^ hash >> 32;
    }
  };

  Cell cell_of(int node) const {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis)
      cell[static_cast<size_t>(axis)] =
          static_cast<std::int64_t>(std::floor((nodes_m_(axis, node) - nodes_m_(axis, 0)) / cell_m_));
    return cell;
  }

  const Eigen::Matrix3Xd& nodes_m_;
  double cell_m_;
  std::unordered_map<Cell, std::vector<int>, Hash> cells_;
};

// Per node, another of a separate piece that lies at the same place, or itself.
std::vector<int> partners(const TetMesh& mesh) {
  Sets pieces(mesh.node_count());
  for (int tet = 0; tet < mesh.tet_count(); ++tet)
    for (const int node : mesh.tets.col(tet)) pieces.unite(node, mesh.tets(0, tet));
  std::vector<int> partner(static_cast<size_t>(mesh.node_count()));
  std::iota(partner.begin(), partner.end(), 0);
  const double near_m = kSamePlace * (mesh.nodes_m.rowwise().maxCoeff() - mesh.nodes_m.rowwise().minCoeff()).norm();
  if (!(near_m > 0.0)) return partner;
  const NodeGrid grid(mesh.nodes_m, near_m);
  for (int node = 0; node < mesh.node_count(); ++node)
    grid.visit_near(node, [&](int other) {
      if (other >= node || pieces.root(other) == pieces.root(node)) return;
      if ((mesh.nodes_m.col(other) - mesh.nodes_m.col(node)).norm() > near_m) return;
      int& known = partner[static_cast<size_t>(node)];
      known = std::min(known, other);
    });
  return partner;
}

// Nodes that no element has left are taken out.
int join_pieces(TetMesh& mesh) {
  std::vector<int> index = partners(mesh);
  int count = 0, joined = 0;
  Eigen::Matrix3Xd nodes_m(3, mesh.node_count());
  for (int node = 0; node < mesh.node_count(); ++node) {
    int& to = index[static_cast<size_t>(node)];
    if (to != node) {
      to = index[static_cast<size_t>(to)];  // which is lower, so it has its new number already
      ++joined;
      continue;
    }
    nodes_m.col(count) = mesh.nodes_m.col(node);
    to = count++;
  }
  const auto renumber = [&](int node) { return index[static_cast<size_t>(node)]; };
  mesh.nodes_m = nodes_m.leftCols(count);
  mesh.tets = mesh.tets.unaryExpr(renumber).eval();
  mesh.faces = mesh.faces.unaryExpr(renumber).eval();
  return joined;
}

// The closed parts of the boundary, as lists of faces: those that hang together through edges of two faces.
std::vector<std::vector<int>> closed_parts(const TetMesh& mesh) {
  std::map<std::pair<int, int>, std::vector<int>> faces_at;
  for (int face = 0; face < mesh.faces.cols(); ++face)
    for (int side = 0; side < 3; ++side)
      faces_at[std::minmax({mesh.faces(side, face), mesh.faces((side + 1) % 3, face)})].push_back(face);
  Sets sets(mesh.faces.cols());
  for (const auto& [edge, faces] : faces_at)
    if (faces.size() == 2) sets.unite(faces[0], faces[1]);
  std::map<int, std::vector<int>> parts;
  for (int face = 0; face < mesh.faces.cols(); ++face) parts[sets.root(face)].push_back(face);
  std::vector<std::vector<int>> all;
  for (auto& [root, faces] : parts) all.push_back(std::move(faces));
  std::sort(all.begin(), all.end());
  return all;
}

double enclosed_volume(const TetMesh& mesh, const std::vector<int>& faces) {
  double six = 0;
  const Eigen::Vector3d from_m = mesh.nodes_m.col(mesh.faces(0, faces[0]));
  for (const int face : faces) {
    const auto corner = [&](int i) -> Eigen::Vector3d { return mesh.nodes_m.col(mesh.faces(i, face)) - from_m; };
    six += corner(0).cross(corner(1)).dot(corner(2));
  }
  return six / 6;
}

int surface_named(const std::string& name, TetMesh& mesh) {
  const auto found = std::find(mesh.surface_names.begin(), mesh.surface_names.end(), name);
  if (found == mesh.surface_names.end()) {
    mesh.surface_names.push_back(name);
    return static_cast<int>(mesh.surface_names.size()) - 1;
  }
  return static_cast<int>(found - mesh.surface_names.begin());
}

// The surface that a part of the boundary is: of one name; or of none yet, which gets `name`; else nothing.
std::string name_part(const std::vector<int>& faces, const std::string& name, TetMesh& mesh) {
  std::set<int> surfaces;
  for (const int face : faces) surfaces.insert(mesh.face_surface[static_cast<size_t>(face)]);
  if (surfaces.size() != 1) return "";
  if (*surfaces.begin() >= 0) return mesh.surface_names[static_cast<size_t>(*surfaces.begin())];
  const int surface = surface_named(name, mesh);
  for (const int face : faces) mesh.face_surface[static_cast<size_t>(face)] = surface;
  return name;
}

// The boundary of a hollow encloses a negative volume, as its faces turn away from the silicone.
void name_boundary(ImportedMesh& imported) {
  TetMesh& mesh = imported.mesh;
  complete_boundary(mesh);
  std::vector<std::pair<double, std::vector<int>>> parts;
  for (std::vector<int>& faces : closed_parts(mesh)) parts.emplace_back(enclosed_volume(mesh, faces), std::move(faces));
  std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  size_t hollows = 0;
  for (const auto& [volume_m3, faces] : parts) {
    if (volume_m3 >= 0) {
      name_part(faces, "skin", mesh);
      continue;
    }
    const std::string name = name_part(faces, ++hollows == 1 ? "cavity" : "cavity_" + std::to_string(hollows), mesh);
    if (!name.empty()) imported.hollows.push_back(name);
  }
}

}  // namespace

ImportedMesh import_mesh(const std::string& file, double unit_m) {
  ImportedMesh imported;
  imported.mesh = read_mesh_file(file, unit_m);
  imported.turned = turn_elements(imported.mesh);
  imported.joined = join_pieces(imported.mesh);
  turn_faces_outward(imported.mesh);
  check_mesh(imported.mesh);
  name_boundary(imported);
  return imported;
}

}  // namespace soft_robot_lab
