// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Geometry>

namespace soft_robot_lab {
namespace {

// r = 3 V / area, R = |a^2 (b x c) + b^2 (c x a) + c^2 (a x b)| / (12 V) with the edges a, b, c from one corner.
double radius_ratio(const Eigen::Matrix<double, 3, 4>& corners) {
  const Eigen::Vector3d a = corners.col(1) - corners.col(0);
  const Eigen::Vector3d b = corners.col(2) - corners.col(0);
  const Eigen::Vector3d c = corners.col(3) - corners.col(0);
  const Eigen::Vector3d bc = b.cross(c), ca = c.cross(a), ab = a.cross(b);
  const double volume = ab.dot(c) / 6;
  const double area = (ab.norm() + bc.norm() + ca.norm() + (b - a).cross(c - a).norm()) / 2;
  const double circumscribed = (a.squaredNorm() * bc + b.squaredNorm() * ca + c.squaredNorm() * ab).norm();
  if (area == 0 || circumscribed == 0) return 0;
  return 9 * volume / area * 12 * std::abs(volume) / circumscribed;
}

double volume_length_ratio(const Eigen::Matrix<double, 3, 4>& corners) {
  double squares = 0;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j) squares += (corners.col(i) - corners.col(j)).squaredNorm() / 6;
  if (squares == 0) return 0;
  const Eigen::Vector3d a = corners.col(1) - corners.col(0), b = corners.col(2) - corners.col(0);
  const double volume = a.cross(b).dot(corners.col(3) - corners.col(0)) / 6;
  return 6 * std::sqrt(2.0) * volume / std::pow(squares, 1.5);
}

Eigen::Matrix<double, 3, 4> corners_of(const Eigen::Matrix3Xd& nodes_m, const Eigen::MatrixXi& tets, Eigen::Index tet) {
  Eigen::Matrix<double, 3, 4> corners;
  for (int i = 0; i < 4; ++i) corners.col(i) = nodes_m.col(tets(i, tet));
  return corners;
}

}  // namespace

MeshQuality measure_quality(const Eigen::Matrix3Xd& nodes_m, const Eigen::MatrixXi& tets) {
  if (tets.cols() == 0) throw std::invalid_argument("mesh quality: the mesh has no element");
  MeshQuality quality{std::numeric_limits<double>::infinity(), 0};
  for (Eigen::Index tet = 0; tet < tets.cols(); ++tet) {
    const double ratio = radius_ratio(corners_of(nodes_m, tets, tet));
    quality.min = std::min(quality.min, ratio);
    quality.mean += ratio / static_cast<double>(tets.cols());
  }
  return quality;
}

std::vector<double> volume_length_qualities(const Eigen::Matrix3Xd& nodes_m, const Eigen::MatrixXi& tets) {
  std::vector<double> qualities;
  for (Eigen::Index tet = 0; tet < tets.cols(); ++tet)
    qualities.push_back(volume_length_ratio(corners_of(nodes_m, tets, tet)));
  return qualities;
}

}  // namespace soft_robot_lab
