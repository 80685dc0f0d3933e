// SPDX-License-Identifier: BSD-3-Clause
#include "reduced_markers.h"

#include <algorithm>

#include "soft_robot_lab/mechanics/embedding.h"

namespace soft_robot_lab {
namespace {

void add_roots(const std::vector<Marker>& markers, const MeshLocator& locator, std::vector<int>& nodes) {
  for (const Marker& marker : markers) {
    const EmbeddedPoint root = locator.embed(marker.rest_position_m());
    nodes.insert(nodes.end(), root.nodes.begin(), root.nodes.end());
  }
}

// Of several bodies a marker may belong to any, wherever it is; nodes too many do no harm.
std::vector<int> nodes_below(const std::vector<Marker>& markers, const TetMesh& mesh) {
  std::vector<int> nodes;
  add_roots(markers, MeshLocator(mesh), nodes);
  const auto bodies = static_cast<int>(mesh.bodies.size());
  for (int body = 0; bodies > 1 && body < bodies; ++body) add_roots(markers, MeshLocator(mesh, body), nodes);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

}  // namespace

ReducedMarkers::ReducedMarkers(const ReducedModel& model)
    : markers_(model.full->markers()),
      nodes_(nodes_below(markers_, model.full->body().mesh())),
      rest_m_(3 * static_cast<Eigen::Index>(nodes_.size())),
      modes_(rest_m_.size(), model.basis.modes.cols()),
      positions_m_(model.full->body().mesh().nodes_m),
      motion_m_(Eigen::Matrix3Xd::Zero(3, positions_m_.cols())) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(3 * i);
    rest_m_.segment<3>(row) = positions_m_.col(nodes_[i]);
    modes_.middleRows<3>(row) = model.basis.modes.middleRows<3>(3 * nodes_[i]);
  }
}

void ReducedMarkers::move_nodes(const Eigen::VectorXd& q) {
  const Eigen::VectorXd places_m = rest_m_ + modes_ * q;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    positions_m_.col(nodes_[i]) = places_m.segment<3>(static_cast<Eigen::Index>(3 * i));
}

Eigen::Matrix3Xd ReducedMarkers::places_m(const Eigen::VectorXd& q) {
  move_nodes(q);
  Eigen::Matrix3Xd places_m(3, static_cast<Eigen::Index>(markers_.size()));
  for (std::size_t m = 0; m < markers_.size(); ++m)
    places_m.col(static_cast<Eigen::Index>(m)) = markers_[m].position(positions_m_);
  return places_m;
}

Eigen::MatrixXd ReducedMarkers::motions(const Eigen::VectorXd& q) {
  move_nodes(q);
  Eigen::MatrixXd motions(3 * static_cast<Eigen::Index>(markers_.size()), modes_.cols());
  for (Eigen::Index k = 0; k < modes_.cols(); ++k) {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      motion_m_.col(nodes_[i]) = modes_.col(k).segment<3>(static_cast<Eigen::Index>(3 * i));
    for (std::size_t m = 0; m < markers_.size(); ++m)
      motions.col(k).segment<3>(static_cast<Eigen::Index>(3 * m)) = markers_[m].velocity(positions_m_, motion_m_);
  }
  return motions;
}

}  // namespace soft_robot_lab
