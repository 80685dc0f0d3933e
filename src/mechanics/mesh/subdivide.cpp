// SPDX-License-Identifier: BSD-3-Clause
#include "subdivide.h"

#include <array>
#include <functional>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "shape_functions.h"

namespace soft_robot_lab {
namespace {

// Reference coordinates of the nodes of a 10-node element.
std::array<Eigen::Vector3d, 10> reference_nodes() {
  std::array<Eigen::Vector3d, 10> nodes;
  nodes[0].setZero();
  for (int i = 0; i < 3; ++i) nodes[i + 1] = Eigen::Vector3d::Unit(i);
  for (int e = 0; e < 6; ++e) nodes[4 + e] = 0.5 * (nodes[kTetEdges[e][0]] + nodes[kTetEdges[e][1]]);
  return nodes;
}

// Four tetrahedra at the corners of a 10-node element, and four around one diagonal of the octahedron that is left.
using Children = std::array<std::array<int, 4>, 8>;
constexpr std::array<std::array<int, 2>, 3> kDiagonals{{{4, 8}, {5, 7}, {6, 9}}};
constexpr std::array<std::array<int, 4>, 3> kRings{{{5, 6, 7, 9}, {4, 6, 8, 9}, {4, 5, 8, 7}}};  // around each diagonal

Children children(int diagonal) {
  Children tets{{{0, 4, 6, 7}, {4, 1, 5, 9}, {6, 5, 2, 8}, {7, 9, 8, 3}}};
  const std::array<Eigen::Vector3d, 10> at = reference_nodes();
  for (int i = 0; i < 4; ++i) {
    std::array<int, 4>& tet = tets[4 + i];
    tet = {kDiagonals[diagonal][0], kDiagonals[diagonal][1], kRings[diagonal][i], kRings[diagonal][(i + 1) % 4]};
    const auto edge = [&](int k) { return Eigen::Vector3d(at[tet[k]] - at[tet[0]]); };
    if (edge(1).cross(edge(2)).dot(edge(3)) < 0.0) std::swap(tet[2], tet[3]);
  }
  return tets;
}

int shortest_diagonal(const std::array<Eigen::Vector3d, 10>& nodes_m) {
  int best = 0;
  const auto length = [&](int i) { return (nodes_m[kDiagonals[i][0]] - nodes_m[kDiagonals[i][1]]).norm(); };
  for (int i = 1; i < 3; ++i)
    if (length(i) < (1.0 - 1e-9) * length(best)) best = i;
  return best;
}

// Gives the middle of two nodes of the fine mesh one number, whichever element asks.
class Middles {
 public:
  explicit Middles(Subdivision& fine) : fine_(fine) {}

  int between(int a, int b, const std::function<EmbeddedPoint()>& point) {
    const auto [entry, made] = numbers_.try_emplace(std::minmax(a, b), static_cast<int>(fine_.parents.size()));
    if (made) fine_.parents.push_back(point());
    return entry->second;
  }
  int known(int a, int b) const { return numbers_.at(std::minmax(a, b)); }

 private:
  Subdivision& fine_;
  std::map<std::pair<int, int>, int> numbers_;
};

class Subdivider {
 public:
  explicit Subdivider(const TetMesh& coarse) : coarse_(coarse), middles_(fine_) {}

  Subdivision run() {
    for (int node = 0; node < coarse_.node_count(); ++node) fine_.parents.push_back({{node}, {1.0}});
    fine_.mesh.tets.resize(coarse_.tets.rows(), 8 * coarse_.tet_count());
    for (int tet = 0; tet < coarse_.tet_count(); ++tet) split_tet(tet);
    split_faces();
    fine_.mesh.surface_names = coarse_.surface_names;
    fine_.mesh.regions = coarse_.regions;
    fine_.mesh.bodies = coarse_.bodies;
    for (const int region : coarse_.tet_region) fine_.mesh.tet_region.insert(fine_.mesh.tet_region.end(), 8, region);
    fine_.mesh.nodes_m = fine_.carry(coarse_.nodes_m);
    return std::move(fine_);
  }

 private:
  void split_tet(int tet) {
    static const std::array<Eigen::Vector3d, 10> local = reference_nodes();
    const auto embedded = [&](const Eigen::Vector3d& at) {
      EmbeddedPoint point;
      const ShapeFunctions shape = shape_functions(static_cast<int>(coarse_.tets.rows()), at);
      for (Eigen::Index a = 0; a < coarse_.tets.rows(); ++a) {
        point.nodes.push_back(coarse_.tets(a, tet));
        point.weights.push_back(shape.values[a]);
      }
      return point;
    };
    std::array<int, 10> number;
    std::array<Eigen::Vector3d, 10> at_m;
    for (int i = 0; i < 4; ++i) number[i] = coarse_.tets(i, tet);
    for (int e = 0; e < 6; ++e) {
      number[4 + e] = coarse_.quadratic() ? coarse_.tets(4 + e, tet)
                                          : middles_.between(number[kTetEdges[e][0]], number[kTetEdges[e][1]],
                                                             [&] { return embedded(local[4 + e]); });
    }
    for (int i = 0; i < 10; ++i) at_m[i] = fine_.parents[number[i]].at(coarse_.nodes_m);

    const Children parts = children(shortest_diagonal(at_m));
    for (int i = 0; i < 8; ++i) {
      auto nodes = fine_.mesh.tets.col(8 * tet + i);
      for (int k = 0; k < 4; ++k) nodes[k] = number[parts[i][k]];
      if (!coarse_.quadratic()) continue;
      for (int e = 0; e < 6; ++e) {
        const int a = kTetEdges[e][0], b = kTetEdges[e][1];
        nodes[4 + e] = middles_.between(nodes[a], nodes[b],
                                        [&] { return embedded(0.5 * (local[parts[i][a]] + local[parts[i][b]])); });
      }
    }
  }

  void split_faces() {
    fine_.mesh.faces.resize(coarse_.faces.rows(), 4 * coarse_.faces.cols());
    for (Eigen::Index face = 0; face < coarse_.faces.cols(); ++face) {
      std::array<int, 6> number;
      for (int i = 0; i < 3; ++i) number[i] = coarse_.faces(i, face);
      for (int i = 0; i < 3; ++i)
        number[3 + i] =
            coarse_.quadratic() ? coarse_.faces(3 + i, face) : middles_.known(number[i], number[(i + 1) % 3]);
      for (int i = 0; i < 4; ++i) {
        auto nodes = fine_.mesh.faces.col(4 * face + i);
        for (int k = 0; k < 3; ++k) nodes[k] = number[kFaceQuarters[i][k]];
        for (int k = 0; k < 3 && coarse_.quadratic(); ++k) nodes[3 + k] = middles_.known(nodes[k], nodes[(k + 1) % 3]);
        fine_.mesh.face_surface.push_back(coarse_.face_surface[face]);
      }
    }
  }

  const TetMesh& coarse_;
  Subdivision fine_;
  Middles middles_;
};

}  // namespace

Eigen::Matrix3Xd Subdivision::carry(const Eigen::Matrix3Xd& coarse) const {
  Eigen::Matrix3Xd fine(3, static_cast<Eigen::Index>(parents.size()));
  for (Eigen::Index node = 0; node < fine.cols(); ++node) fine.col(node) = parents[node].at(coarse);
  return fine;
}

Subdivision subdivide(const TetMesh& coarse) { return Subdivider(coarse).run(); }

}  // namespace soft_robot_lab
