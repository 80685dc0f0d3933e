// SPDX-License-Identifier: BSD-3-Clause
#include "skin.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

// Weights of a face's nodes (corners, then mid-edges 01, 12, 20) at the barycentric coordinates `l`.
Eigen::VectorXd face_weights(Eigen::Index node_count, const Eigen::Vector3d& l) {
  if (node_count == 3) return l;
  Eigen::VectorXd weights(6);
  for (int i = 0; i < 3; ++i) {
    weights[i] = l[i] * (2 * l[i] - 1);
    weights[3 + i] = 4 * l[i] * l[(i + 1) % 3];
  }
  return weights;
}

// Numbers the vertices so that neighbouring faces share those on their common edge.
class Cutter {
 public:
  Cutter(const TetMesh& mesh, int cuts) : mesh_(mesh), cuts_(mesh.faces.rows() == 6 ? cuts : 1) {}

  void cut(int face) {
    // Row i has cuts - i + 1 vertices; i counts towards corner 2, j towards corner 1.
    std::vector<std::vector<int>> rows;
    for (int i = 0; i <= cuts_; ++i) {
      rows.emplace_back();
      for (int j = 0; i + j <= cuts_; ++j) rows.back().push_back(vertex(face, {cuts_ - i - j, j, i}));
    }
    for (std::size_t i = 0; i + 1 < rows.size(); ++i)
      for (std::size_t j = 0; j + 1 < rows[i].size(); ++j) {
        triangles.push_back({rows[i][j], rows[i][j + 1], rows[i + 1][j]});
        if (j + 2 < rows[i].size()) triangles.push_back({rows[i][j + 1], rows[i + 1][j + 1], rows[i + 1][j]});
      }
  }

  std::vector<Eigen::Vector3i> triangles;
  std::vector<Eigen::Triplet<double>> weights;
  int vertex_count = 0;

 private:
  using Key = std::vector<std::pair<int, int>>;  // corner node, its coordinate; those that are not zero

  int vertex(int face, const std::array<int, 3>& coordinates) {
    Key key;
    for (int k = 0; k < 3; ++k)
      if (coordinates[static_cast<std::size_t>(k)] > 0)
        key.emplace_back(mesh_.faces(k, face), coordinates[static_cast<std::size_t>(k)]);
    std::sort(key.begin(), key.end());
    const auto [place, is_new] = vertices_.emplace(key, vertex_count);
    if (is_new) {
      const Eigen::Vector3d l = Eigen::Vector3d(coordinates[0], coordinates[1], coordinates[2]) / cuts_;
      const Eigen::VectorXd values = face_weights(mesh_.faces.rows(), l);
      for (Eigen::Index a = 0; a < values.size(); ++a)
        if (values[a] != 0) weights.emplace_back(mesh_.faces(a, face), vertex_count, values[a]);
      ++vertex_count;
    }
    return place->second;
  }

  const TetMesh& mesh_;
  int cuts_;
  std::map<Key, int> vertices_;
};

}  // namespace

std::vector<int> outer_faces(const TetMesh& mesh) {
  // Faces hang together where they share a corner. Around the whole body they enclose more volume than anywhere inside.
  std::vector<int> parents(static_cast<std::size_t>(mesh.node_count()));
  std::iota(parents.begin(), parents.end(), 0);
  const auto root = [&](int node) {
    while (parents[static_cast<std::size_t>(node)] != node) node = parents[static_cast<std::size_t>(node)];
    return node;
  };
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f)
    for (int k = 1; k < 3; ++k) parents[static_cast<std::size_t>(root(mesh.faces(k, f)))] = root(mesh.faces(0, f));
  std::map<int, double> volume_m3;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const Eigen::Vector3d a = mesh.nodes_m.col(mesh.faces(0, f)), b = mesh.nodes_m.col(mesh.faces(1, f)),
                          c = mesh.nodes_m.col(mesh.faces(2, f));
    volume_m3[root(mesh.faces(0, f))] += a.dot(b.cross(c)) / 6;
  }
  std::vector<int> faces;
  for (int f = 0; f < mesh.faces.cols(); ++f)
    if (volume_m3[root(mesh.faces(0, f))] > 0) faces.push_back(f);
  return faces;
}

Skin::Skin(const TetMesh& mesh, int cuts) {
  if (cuts < 1 || cuts > 64)
    throw std::invalid_argument("cuts of a face's side are " + std::to_string(cuts) + "; allowed: [1, 64]");
  Cutter cutter(mesh, cuts);
  for (const int face : outer_faces(mesh)) cutter.cut(face);
  triangles_.resize(3, static_cast<Eigen::Index>(cutter.triangles.size()));
  for (std::size_t t = 0; t < cutter.triangles.size(); ++t)
    triangles_.col(static_cast<Eigen::Index>(t)) = cutter.triangles[t];
  weights_.resize(mesh.node_count(), cutter.vertex_count);
  weights_.setFromTriplets(cutter.weights.begin(), cutter.weights.end());
}

}  // namespace soft_robot_lab
