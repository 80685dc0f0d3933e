// SPDX-License-Identifier: BSD-3-Clause
#include "distance_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace soft_robot_lab {
namespace {

using Eigen::Array3i;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kExact = 3.5;   // steps from the surface within which every node has its exact distance
constexpr double kFar = 5.0;     // steps from the surface beyond which one node is enough
constexpr double kMargin = 6.0;  // steps around the surface
constexpr double kSafe = 0.9;    // farther away no distance is overestimated
constexpr double kNone = std::numeric_limits<double>::infinity();

// Of a surface in a frame about its centroid, in steps.
Eigen::AlignedBox3d box_of(const ClosedSurface& surface, const Matrix3d& frame, double step_m) {
  const Eigen::Matrix3Xd at = frame.transpose() * (surface.vertices_m().colwise() - surface.centroid_m()) / step_m;
  return {at.rowwise().minCoeff(), at.rowwise().maxCoeff()};
}

// Nodes before the centroid, and all.
Eigen::Matrix<double, 3, 2> extent(const Eigen::AlignedBox3d& box) {
  Eigen::Matrix<double, 3, 2> nodes;
  nodes.col(0) = (Vector3d::Constant(kMargin) - box.min()).array().ceil();
  nodes.col(1) = nodes.col(0).array() + (box.max().array() + kMargin).ceil() + 1.0;
  return nodes;
}

// Weights of four nodes, and their first two derivatives.
struct Weights {
  std::array<double, 4> value, slope, bend;

  explicit Weights(double t) {
    const double s = 1.0 - t;
    value = {s * s * s / 6.0, (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0, (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
             t * t * t / 6.0};
    slope = {-0.5 * s * s, 0.5 * t * (3.0 * t - 4.0), -0.5 * s * (3.0 * s - 4.0), 0.5 * t * t};
    bend = {s, 3.0 * t - 2.0, 3.0 * s - 2.0, t};
  }
};

// |grad d| = 1 by the nearest values along each axis (Zhao 2005).
double eikonal(std::array<double, 3> near) {
  std::sort(near.begin(), near.end());
  double d = near[0] + 1.0;
  if (d <= near[1]) return d;
  const double apart = near[1] - near[0];
  d = 0.5 * (near[0] + near[1] + std::sqrt(2.0 - apart * apart));
  if (d <= near[2]) return d;
  const double sum = near[0] + near[1] + near[2], squares = near[0] * near[0] + near[1] * near[1] + near[2] * near[2];
  return (sum + std::sqrt(std::max(0.0, sum * sum - 3.0 * (squares - 1.0)))) / 3.0;
}

}  // namespace

double DistanceGrid::node_count(const ClosedSurface& surface, double step_m) {
  return extent(box_of(surface, surface.frame(), step_m)).col(1).prod();
}

DistanceGrid::DistanceGrid(const ClosedSurface& surface, double step_m)
    : step_m_(step_m), frame_(surface.frame()), centroid_m_(surface.centroid_m()) {
  const Eigen::Matrix<double, 3, 2> nodes = extent(box_of(surface, frame_, step_m));
  centroid_ = nodes.col(0);
  size_ = nodes.col(1).cast<int>().array();
  last_ = nodes.col(1) - Vector3d::Constant(2.0 + 1e-9);
  values_.assign(
      static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(size_[2]),
      kNone);
  measure_near(surface);
  fill_far();
}

void DistanceGrid::measure_near(const ClosedSurface& surface) {
  for (Eigen::Index t = 0; t < surface.count(); ++t)
    if (surface.area_m2(t) > 0.0) measure_near(surface, t);
}

void DistanceGrid::measure_near(const ClosedSurface& surface, Eigen::Index triangle) {
  Matrix3d corners;
  for (int k = 0; k < 3; ++k) corners.col(k) = to_steps(surface.corners_m(triangle).col(k));
  const Vector3d normal = frame_.transpose() * surface.normal(triangle);
  const Array3i low = (corners.rowwise().minCoeff().array() - kExact).ceil().cast<int>().max(0),
                high = (corners.rowwise().maxCoeff().array() + kExact).floor().cast<int>().min(size_ - 1);
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      // Of a row only what is near the triangle's plane.
      int from = low[0], to = high[0];
      if (std::abs(normal[0]) > 1e-3) {
        const double middle =
            corners(0, 0) - (normal[1] * (j - corners(1, 0)) + normal[2] * (k - corners(2, 0))) / normal[0];
        const double reach = kExact / std::abs(normal[0]);
        from = std::max(from, static_cast<int>(std::ceil(std::max(middle - reach, -1.0))));
        to = std::min(to, static_cast<int>(std::floor(std::min(middle + reach, static_cast<double>(size_[0])))));
      }
      for (int i = from; i <= to; ++i) {
        const Vector3d node(i, j, k);
        const NearestOnTriangle nearest = nearest_on_triangle(node, corners);
        const double distance = (node - nearest.at_m).norm();
        double& value = values_[index({i, j, k})];
        if (distance >= std::abs(value)) continue;
        const Vector3d outward = frame_.transpose() * surface.outward(triangle, nearest);
        value = outward.dot(node - nearest.at_m) < 0.0 ? -distance : distance;
      }
    }
  }
}

void DistanceGrid::fill_far() {
  for (double& value : values_)
    if (std::abs(value) > kExact) value = kNone;
  for (int round = 0; round < 8; ++round) fill_far({round & 1 ? -1 : 1, round & 2 ? -1 : 1, round & 4 ? -1 : 1});
  for (double& value : values_) {
    const double distance = std::abs(value);
    if (distance > kExact) value = std::copysign(kExact + kSafe * (distance - kExact), value);
  }
}

void DistanceGrid::fill_far(const Array3i& way) {
  const auto at = [&](int axis, int i) { return way[axis] > 0 ? i : size_[axis] - 1 - i; };
  for (int k = 0; k < size_[2]; ++k)
    for (int j = 0; j < size_[1]; ++j)
      for (int i = 0; i < size_[0]; ++i) fill({at(0, i), at(1, j), at(2, k)});
}

// The surface is not between two nodes that are far from it, so signs go on.
void DistanceGrid::fill(const Array3i& node) {
  double& value = values_[index(node)];
  if (std::abs(value) <= kExact) return;
  std::array<double, 3> near{kNone, kNone, kNone};
  double nearest = kNone;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int way : {-1, 1}) {
      Array3i beside = node;
      beside[axis] += way;
      if (beside[axis] < 0 || beside[axis] >= size_[axis]) continue;
      const double other = values_[index(beside)];
      if (std::abs(other) < std::abs(nearest)) nearest = other;
      near[static_cast<std::size_t>(axis)] = std::min(near[static_cast<std::size_t>(axis)], std::abs(other));
    }
  }
  if (std::abs(nearest) == kNone) return;
  const double distance = std::max(eikonal(near), kExact * (1.0 + 1e-12));
  if (distance < std::abs(value)) value = std::copysign(distance, nearest);
}

SplineValue DistanceGrid::spline(const Vector3d& at) const {
  const Array3i first = at.array().floor().cast<int>() - 1;
  const Vector3d part = at.array() - at.array().floor();
  const Weights x(part[0]), y(part[1]), z(part[2]);
  SplineValue sum{0.0, Vector3d::Zero(), Matrix3d::Zero()};
  for (std::size_t k = 0; k < 4; ++k) {
    double f = 0, fx = 0, fy = 0, fxx = 0, fxy = 0, fyy = 0;
    for (std::size_t j = 0; j < 4; ++j) {
      const double* row = &values_[index({first[0], first[1] + static_cast<int>(j), first[2] + static_cast<int>(k)})];
      double g = 0, gx = 0, gxx = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        g += x.value[i] * row[i];
        gx += x.slope[i] * row[i];
        gxx += x.bend[i] * row[i];
      }
      f += y.value[j] * g;
      fx += y.value[j] * gx;
      fxx += y.value[j] * gxx;
      fy += y.slope[j] * g;
      fxy += y.slope[j] * gx;
      fyy += y.bend[j] * g;
    }
    sum.value += z.value[k] * f;
    sum.slope += Vector3d(z.value[k] * fx, z.value[k] * fy, z.slope[k] * f);
    sum.bend(0, 0) += z.value[k] * fxx;
    sum.bend(1, 0) += z.value[k] * fxy;
    sum.bend(1, 1) += z.value[k] * fyy;
    sum.bend(2, 0) += z.slope[k] * fx;
    sum.bend(2, 1) += z.slope[k] * fy;
    sum.bend(2, 2) += z.bend[k] * f;
  }
  sum.bend.triangularView<Eigen::StrictlyUpper>() = sum.bend.transpose();
  return sum;
}

std::optional<Gap> DistanceGrid::far(const Vector3d& at) const {
  const Array3i node = at.array().round().cast<int>();
  const double value = values_[index(node)];
  if (std::abs(value) < kFar) return std::nullopt;
  Vector3d slope;
  for (int axis = 0; axis < 3; ++axis) {
    Array3i more = node, less = node;
    ++more[axis], --less[axis];
    slope[axis] = 0.5 * (values_[index(more)] - values_[index(less)]);
  }
  const double length = slope.norm();
  const Vector3d from_node = at - node.cast<double>().matrix();
  return Gap{value + (value > 0.0 ? -from_node.norm() : slope.dot(from_node)),
             length > 0.0 ? Vector3d(slope / length) : Vector3d::UnitZ(), Matrix3d::Zero()};
}

Vector3d DistanceGrid::deepest() const {
  const auto least = static_cast<std::size_t>(std::min_element(values_.begin(), values_.end()) - values_.begin());
  const auto nx = static_cast<std::size_t>(size_[0]), ny = static_cast<std::size_t>(size_[1]);
  return Vector3d(static_cast<double>(least % nx), static_cast<double>(least / nx % ny),
                  static_cast<double>(least / (nx * ny)));
}

}  // namespace soft_robot_lab
