// SPDX-License-Identifier: BSD-3-Clause
#include "push_cone.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace soft_robot_lab {
namespace {

constexpr int kDirections = 12;  // of the cone's edge, before the best of them is refined
constexpr int kRefinements = 6;  // each halves the angle

}  // namespace

Eigen::Vector3d best_along(const ForceQuadratic& quadratic, const Eigen::Vector3d& direction) {
  const double pull = quadratic.g.dot(direction);
  if (!(pull > 0.0)) return Eigen::Vector3d::Zero();
  return pull / direction.dot(quadratic.h * direction) * direction;
}

Eigen::Vector3d best_push(const ForceQuadratic& quadratic, const Eigen::Vector3d& normal, double mu) {
  const Eigen::Vector3d free = quadratic.h.inverse() * quadratic.g;
  const double into = -free.dot(normal);
  if (into >= 0.0 && (free + into * normal).norm() <= mu * into) return free;
  // The quadratic is convex, so its least value in the cone lies on the cone's edge.
  const Eigen::Vector3d first = normal.unitOrthogonal(), second = normal.cross(first);
  const auto on_edge = [&](double angle) {
    return best_along(quadratic, (-normal + mu * (std::cos(angle) * first + std::sin(angle) * second)).normalized());
  };
  double best_angle = 0.0, step = 2.0 * M_PI / kDirections;
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  double most = 0.0;
  const auto look = [&](double angle) {
    const Eigen::Vector3d force = on_edge(angle);
    const double gain = quadratic.gain(force);
    if (!(gain > most)) return;
    most = gain;
    best = force;
    best_angle = angle;
  };
  for (int i = 0; i < kDirections; ++i) look(i * step);
  if (most == 0.0) return best;
  for (int i = 0; i < kRefinements; ++i) {
    step *= 0.5;
    const double centre = best_angle;
    look(centre - step);
    look(centre + step);
  }
  return best;
}

}  // namespace soft_robot_lab
