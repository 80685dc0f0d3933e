// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/embedding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "shape_functions.h"
#include "skin.h"

namespace soft_robot_lab {
namespace {

constexpr double kInsideTolerance = 1e-9;  // in reference coordinates

Eigen::Vector4d barycentric(const Eigen::Vector3d& local) {
  return {1.0 - local.sum(), local.x(), local.y(), local.z()};
}

// Reference coordinates of a rest point, by Newton on the (possibly curved) element's map.
std::optional<Eigen::Vector3d> invert_map(const TetMesh& mesh, int tet, const Eigen::Vector3d& point) {
  const int nodes = static_cast<int>(mesh.tets.rows());
  Eigen::Vector3d local = Eigen::Vector3d::Constant(0.25);
  for (int iteration = 0; iteration < 30; ++iteration) {
    const ShapeFunctions shape = shape_functions(nodes, local);
    Eigen::Vector3d mapped = Eigen::Vector3d::Zero();
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
    for (int a = 0; a < nodes; ++a) {
      mapped += shape.values[a] * mesh.nodes_m.col(mesh.tets(a, tet));
      jacobian += mesh.nodes_m.col(mesh.tets(a, tet)) * shape.gradients.col(a).transpose();
    }
    const Eigen::Vector3d step = jacobian.partialPivLu().solve(point - mapped);
    if (!step.allFinite() || local.norm() > 10.0) return std::nullopt;
    local += step;
    if (step.norm() < 1e-13) return local;
  }
  return std::nullopt;
}

// Across the normal, towards that corner of the body around the point that is farthest from the axis: it turns with the
// body. Of corners that are equally far the first one counts.
Eigen::Vector3d across(const TetMesh& mesh, int body, const Eigen::Vector3d& center_m, const Eigen::Vector3d& normal) {
  constexpr double kFarther = 1.0 + 1e-9;
  const Eigen::Vector3d along = normal.normalized();
  Eigen::Vector3d farthest_m = Eigen::Vector3d::Zero();
  for (int tet = 0; tet < mesh.tet_count(); ++tet) {
    if (mesh.body_of(tet) != body) continue;
    for (int corner = 0; corner < 4; ++corner) {
      const Eigen::Vector3d from_m = mesh.nodes_m.col(mesh.tets(corner, tet)) - center_m;
      const Eigen::Vector3d off_m = from_m - along * along.dot(from_m);
      if (off_m.norm() > kFarther * farthest_m.norm()) farthest_m = off_m;
    }
  }
  return farthest_m.normalized();
}

}  // namespace

Eigen::Vector3d EmbeddedPoint::at(const Eigen::Matrix3Xd& positions_m) const {
  Eigen::Vector3d sum = offset_m;
  for (std::size_t i = 0; i < nodes.size(); ++i) sum += weights[i] * positions_m.col(nodes[i]);
  return sum;
}

EmbeddedPoint average(const std::vector<EmbeddedPoint>& points) {
  if (points.empty()) throw std::invalid_argument("average of no points");
  std::map<int, double> sums;
  for (const EmbeddedPoint& point : points)
    for (std::size_t i = 0; i < point.nodes.size(); ++i)
      sums[point.nodes[i]] += point.weights[i] / static_cast<double>(points.size());
  EmbeddedPoint result;
  for (const EmbeddedPoint& point : points) result.offset_m += point.offset_m / static_cast<double>(points.size());
  for (const auto& [node, weight] : sums) {
    result.nodes.push_back(node);
    result.weights.push_back(weight);
  }
  return result;
}

MeshLocator::MeshLocator(const TetMesh& mesh, std::optional<int> only_body)
    : mesh_(mesh),
      box_min_m_(Eigen::Matrix3Xd::Constant(3, mesh.tet_count(), std::numeric_limits<double>::infinity())),
      box_max_m_(-box_min_m_) {
  const std::vector<int> bodies = bodies_of_nodes(mesh);
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    if (!only_body || bodies[static_cast<std::size_t>(mesh.faces(0, face))] == *only_body) faces_.push_back(face);
  for (int tet = 0; tet < mesh.tet_count(); ++tet) {
    if (only_body && mesh.body_of(tet) != *only_body) continue;
    Eigen::Vector3d min = mesh.nodes_m.col(mesh.tets(0, tet)), max = min;
    for (Eigen::Index a = 1; a < mesh.tets.rows(); ++a) {
      min = min.cwiseMin(mesh.nodes_m.col(mesh.tets(a, tet)));
      max = max.cwiseMax(mesh.nodes_m.col(mesh.tets(a, tet)));
    }
    // A curved element may bulge a little beyond its nodes.
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(0.15 * (max - min).norm());
    box_min_m_.col(tet) = min - margin;
    box_max_m_.col(tet) = max + margin;
  }
}

Location MeshLocator::locate(const Eigen::Vector3d& point_m) const {
  if (!point_m.allFinite()) throw std::invalid_argument("point is not finite");
  Location best;
  double best_inside = -std::numeric_limits<double>::infinity();
  const auto consider = [&](const Eigen::Vector3d& point) {
    for (int tet = 0; tet < mesh_.tet_count(); ++tet) {
      if ((point.array() < box_min_m_.col(tet).array()).any() || (point.array() > box_max_m_.col(tet).array()).any())
        continue;
      const auto local = invert_map(mesh_, tet, point);
      if (!local) continue;
      const double depth = barycentric(*local).minCoeff();
      if (depth <= best_inside) continue;
      best_inside = depth;
      best.tet = tet;
      best.local = *local;
    }
  };
  consider(point_m);
  best.nearest_m = point_m;
  if (best_inside >= -kInsideTolerance) return best;

  const SkinPoint skin = nearest_on_skin(mesh_, faces_, point_m);
  best.nearest_m = skin.position_m;
  best_inside = -std::numeric_limits<double>::infinity();
  best.tet = -1;
  consider(best.nearest_m);
  if (best.tet < 0) throw std::invalid_argument("no element found for a point; the mesh has no boundary faces");
  best.distance_m = skin.distance_m;
  return best;
}

EmbeddedPoint MeshLocator::embed(const Location& location) const {
  EmbeddedPoint point;
  const ShapeFunctions shape = shape_functions(static_cast<int>(mesh_.tets.rows()), location.local);
  for (Eigen::Index a = 0; a < mesh_.tets.rows(); ++a) {
    point.nodes.push_back(mesh_.tets(a, location.tet));
    point.weights.push_back(shape.values[a]);
  }
  return point;
}

EmbeddedPoint MeshLocator::embed_disc(const Eigen::Vector3d& center_m, const Eigen::Vector3d& normal,
                                      double radius_m) const {
  // One point in the middle and two rings of equal-area cells: the mean of a quadratic field is off by less than 2 %.
  std::vector<EmbeddedPoint> samples;
  const Eigen::Vector3d u = across(mesh_, mesh_.body_of(locate(center_m).tet), center_m, normal),
                        v = normal.normalized().cross(u);
  const auto take = [&](double radius, double angle) {
    const Location location = locate(center_m + radius * (std::cos(angle) * u + std::sin(angle) * v));
    if (location.distance_m <= 1e-6 * radius_m) samples.push_back(embed(location));
  };
  take(0.0, 0.0);
  if (radius_m > 0.0) {
    for (int i = 0; i < 6; ++i) take(0.5 * radius_m, M_PI / 3.0 * i);
    for (int i = 0; i < 12; ++i) take(0.85 * radius_m, M_PI / 6.0 * (i + 0.5));
  }
  return samples.empty() ? embed(center_m) : average(samples);
}

EmbeddedPoint MeshLocator::embed_box(const Eigen::Vector3d& center_m, double edge_m) const {
  constexpr int kPerEdge = 6;
  std::vector<EmbeddedPoint> samples;
  for (int i = 0; i < kPerEdge * kPerEdge * kPerEdge; ++i) {
    const Eigen::Vector3i cell(i % kPerEdge, (i / kPerEdge) % kPerEdge, i / (kPerEdge * kPerEdge));
    const Eigen::Array3d place = (cell.array().cast<double>() + 0.5) / kPerEdge - 0.5;
    const Location location = locate(center_m + edge_m * place.matrix());
    if (location.distance_m <= 1e-6 * edge_m) samples.push_back(embed(location));
  }
  return samples.empty() ? embed(center_m) : average(samples);
}

}  // namespace soft_robot_lab
