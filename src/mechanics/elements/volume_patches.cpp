// SPDX-License-Identifier: BSD-3-Clause
#include "volume_patches.h"

#include <algorithm>

namespace soft_robot_lab {
namespace {

// Per vertex, the nodes of the elements around it; each once.
std::vector<std::vector<int>> nodes_around(const std::vector<std::array<int, 4>>& elements, int node_count) {
  std::vector<std::vector<int>> around(static_cast<std::size_t>(node_count));
  for (const auto& nodes : elements)
    for (const int node : nodes) around[node].insert(around[node].end(), nodes.begin(), nodes.end());
  for (auto& nodes : around) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  }
  return around;
}

}  // namespace

std::vector<std::vector<int>> stiffness_cliques(const Body& body) {
  const TetMesh& mesh = body.mesh();
  if (body.linear_volume() == LinearVolume::vertex_averaged) {
    std::vector<std::array<int, 4>> elements;
    elements.reserve(static_cast<std::size_t>(mesh.tet_count()));
    for (int e = 0; e < mesh.tet_count(); ++e)
      elements.push_back({mesh.tets(0, e), mesh.tets(1, e), mesh.tets(2, e), mesh.tets(3, e)});
    return nodes_around(elements, mesh.node_count());
  }
  std::vector<std::vector<int>> cliques;
  for (Eigen::Index e = 0; e < mesh.tets.cols(); ++e)
    cliques.emplace_back(mesh.tets.col(e).data(), mesh.tets.col(e).data() + mesh.tets.rows());
  return cliques;
}

VolumePatches::VolumePatches(const ElementBatches& batches, const Eigen::VectorXd& element_volumes_m3,
                             const BlockPattern& matrix) {
  int node_count = 0;
  for (Eigen::Index e = 0; e < element_volumes_m3.size(); ++e) {
    std::array<int, 4> nodes;
    for (int a = 0; a < 4; ++a) {
      nodes[a] = batches.nodes[static_cast<std::size_t>(e / kLanes * 4 + a) * kLanes + e % kLanes];
      node_count = std::max(node_count, nodes[a] + 1);
    }
    vertices_.push_back(nodes);
  }
  auto around = nodes_around(vertices_, node_count);
  patches_.resize(around.size());
  for (std::size_t vertex = 0; vertex < around.size(); ++vertex) {
    std::vector<int>& nodes = around[vertex];
    std::sort(nodes.begin(), nodes.end(), [&](int a, int b) { return matrix.position(a) < matrix.position(b); });
    patches_[vertex].node_count = static_cast<int>(nodes.size());
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (std::size_t b = 0; b <= a; ++b)
        patches_[vertex].slots.push_back(matrix.slot(matrix.position(nodes[a]), matrix.position(nodes[b])));
  }
  for (std::size_t e = 0; e < vertices_.size(); ++e) {
    for (const int vertex : vertices_[e]) {
      const std::vector<int>& nodes = around[vertex];
      Share fraction{static_cast<int>(e), {}};
      for (int a = 0; a < 4; ++a)
        fraction.places[a] = static_cast<int>(std::find(nodes.begin(), nodes.end(), vertices_[e][a]) - nodes.begin());
      patches_[vertex].fractions.push_back(fraction);
    }
  }
  volumes_ = on_vertices(element_volumes_m3);
}

Eigen::VectorXd VolumePatches::on_elements(const Eigen::VectorXd& of_vertices) const {
  Eigen::VectorXd result(static_cast<Eigen::Index>(vertices_.size()));
  for (std::size_t e = 0; e < vertices_.size(); ++e) {
    const auto& v = vertices_[e];
    result[static_cast<Eigen::Index>(e)] =
        0.25 * (of_vertices[v[0]] + of_vertices[v[1]] + of_vertices[v[2]] + of_vertices[v[3]]);
  }
  return result;
}

Eigen::VectorXd VolumePatches::on_vertices(const Eigen::VectorXd& of_elements) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(patches_.size()));
  for (std::size_t e = 0; e < vertices_.size(); ++e)
    for (const int vertex : vertices_[e]) result[vertex] += 0.25 * of_elements[static_cast<Eigen::Index>(e)];
  return result;
}

void VolumePatches::add_hessian(const Batches& gradients, double lambda_pa, BlockMatrix& matrix) const {
  for (std::size_t vertex = 0; vertex < patches_.size(); ++vertex) {
    const Patch& patch = patches_[vertex];
    Eigen::Matrix3Xd g = Eigen::Matrix3Xd::Zero(3, patch.node_count);
    for (const Share& fraction : patch.fractions)
      for (int a = 0; a < 4; ++a)
        for (int i = 0; i < 3; ++i)
          g(i, fraction.places[a]) +=
              0.25 *
              gradients[static_cast<std::size_t>(fraction.element / kLanes * 4 + a) * 3 + i][fraction.element % kLanes];
    const double stiffness = lambda_pa / volumes_[static_cast<Eigen::Index>(vertex)];
    std::size_t pair = 0;
    for (int a = 0; a < patch.node_count; ++a)
      for (int b = 0; b <= a; ++b, ++pair)
        Eigen::Map<Eigen::Matrix3d>(matrix.block(patch.slots[pair])) += stiffness * g.col(a) * g.col(b).transpose();
  }
}

}  // namespace soft_robot_lab
