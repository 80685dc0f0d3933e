// SPDX-License-Identifier: BSD-3-Clause
// Structured test meshes of hollow bodies: a lattice of cells, those of the hollow left out, each other cut into six
// tetrahedra, mirrored about the origin's planes so that a symmetric body has a symmetric mesh.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <vector>

#include <Eigen/Dense>

#include "mechanics/mesh/tet_faces.h"
#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

struct HollowLattice {
  std::array<std::vector<double>, 3> planes_m;  // rising, along x, y, z
  Eigen::Vector3d hollow_min_m, hollow_max_m;   // on planes, or beyond them for a hollow that is open there
  bool quadratic = true;
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> map;  // moves every node; may be empty
};

// -b, ..., -a, 0, a, ..., b
inline std::vector<double> mirrored(std::vector<double> positive) {
  std::vector<double> all(positive.rbegin(), positive.rend());
  for (double& x : all) x = -x;
  all.push_back(0.0);
  all.insert(all.end(), positive.begin(), positive.end());
  return all;
}

class HollowMesher {
 public:
  explicit HollowMesher(const HollowLattice& lattice) : lattice_(lattice) {}

  // The hollow's wall is the surface "cavity".
  TetMesh mesh() {
    for (int i = 0; i + 1 < size(0); ++i)
      for (int j = 0; j + 1 < size(1); ++j)
        for (int k = 0; k + 1 < size(2); ++k)
          if (!hollow(centre({i, j, k}))) add_cell({i, j, k});
    TetMesh mesh;
    mesh.nodes_m.resize(3, static_cast<Eigen::Index>(nodes_.size()));
    for (std::size_t i = 0; i < nodes_.size(); ++i) mesh.nodes_m.col(static_cast<Eigen::Index>(i)) = nodes_[i];
    mesh.tets.resize(4, static_cast<Eigen::Index>(tets_.size()));
    for (std::size_t i = 0; i < tets_.size(); ++i) mesh.tets.col(static_cast<Eigen::Index>(i)) = tets_[i];
    if (lattice_.quadratic) mesh = make_quadratic(mesh);
    complete_boundary(mesh);
    mesh.surface_names = {"cavity"};
    for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
      mesh.face_surface[static_cast<std::size_t>(face)] = bounds_hollow(mesh, face) ? 0 : -1;
    if (lattice_.map)
      for (Eigen::Index i = 0; i < mesh.nodes_m.cols(); ++i)
        mesh.nodes_m.col(i) = lattice_.map(Eigen::Vector3d(mesh.nodes_m.col(i)));
    return mesh;
  }

 private:
  using Place = std::array<int, 3>;

  int size(int axis) const { return static_cast<int>(lattice_.planes_m[axis].size()); }
  Eigen::Vector3d at(const Place& place) const {
    return {lattice_.planes_m[0][place[0]], lattice_.planes_m[1][place[1]], lattice_.planes_m[2][place[2]]};
  }
  Eigen::Vector3d centre(const Place& cell) const {
    return 0.5 * (at(cell) + at({cell[0] + 1, cell[1] + 1, cell[2] + 1}));
  }
  bool hollow(const Eigen::Vector3d& point) const {
    return (point.array() > lattice_.hollow_min_m.array()).all() &&
           (point.array() < lattice_.hollow_max_m.array()).all();
  }
  // A boundary face whose outside, a little beyond it, is hollow.
  bool bounds_hollow(const TetMesh& mesh, Eigen::Index face) const {
    const Eigen::Vector3d a = mesh.nodes_m.col(mesh.faces(0, face)), b = mesh.nodes_m.col(mesh.faces(1, face)),
                          c = mesh.nodes_m.col(mesh.faces(2, face));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const Eigen::Vector3d beyond = (a + b + c) / 3.0 + 1e-6 * normal / std::sqrt(normal.norm());
    Eigen::Vector3d low, high;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = lattice_.planes_m[axis].front();
      high[axis] = lattice_.planes_m[axis].back();
    }
    return hollow(beyond) && (beyond.array() > low.array()).all() && (beyond.array() < high.array()).all();
  }

  int node(const Place& place) {
    const auto [found, added] = index_.emplace(place, static_cast<int>(nodes_.size()));
    if (added) nodes_.push_back(at(place));
    return found->second;
  }

  // One tetrahedron per order of the axes, along the diagonal that points away from the origin's planes.
  void add_cell(const Place& cell) {
    Place start = cell, towards{1, 1, 1};
    const Eigen::Vector3d middle = centre(cell);
    for (int axis = 0; axis < 3; ++axis) {
      if (middle[axis] > 0.0) continue;
      ++start[axis];
      towards[axis] = -1;
    }
    std::array<int, 3> order{0, 1, 2};
    do {
      Place place = start;
      Eigen::Vector4i tet;
      tet[0] = node(place);
      for (int step = 0; step < 3; ++step) {
        place[order[step]] += towards[order[step]];
        tet[step + 1] = node(place);
      }
      Eigen::Matrix3d edges;
      for (int i = 0; i < 3; ++i) edges.col(i) = nodes_[tet[i + 1]] - nodes_[tet[0]];
      if (edges.determinant() < 0.0) std::swap(tet[1], tet[2]);
      tets_.push_back(tet);
    } while (std::next_permutation(order.begin(), order.end()));
  }

  const HollowLattice& lattice_;
  std::map<Place, int> index_;
  std::vector<Eigen::Vector3d> nodes_;
  std::vector<Eigen::Vector4i> tets_;
};

inline TetMesh hollow_mesh(const HollowLattice& lattice) { return HollowMesher(lattice).mesh(); }

// A small closed box with a hollow of a third of its edge; `scale` 1 is an edge of 30 mm.
inline TetMesh hollow_cube(double scale = 1.0, bool quadratic = true) {
  const std::vector<double> planes = mirrored({0.005 * scale, 0.015 * scale});
  const Eigen::Vector3d corner = Eigen::Vector3d::Constant(0.005 * scale);
  return hollow_mesh({{planes, planes, planes}, -corner, corner, quadratic, {}});
}

// A box of 20 mm edge with a hollow of 10 mm that reaches through its top.
inline TetMesh open_box(bool quadratic = true) {
  const std::vector<double> planes = mirrored({0.005, 0.010});
  return hollow_mesh({{planes, planes, planes}, {-0.005, -0.005, -0.005}, {0.005, 0.005, 1.0}, quadratic, {}});
}

}  // namespace soft_robot_lab
