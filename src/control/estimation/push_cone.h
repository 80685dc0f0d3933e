// SPDX-License-Identifier: BSD-3-Clause
// The most probable push at a place: a force within Coulomb's cone around the inward normal.
#pragma once

#include <Eigen/Core>

namespace soft_robot_lab {

// A quadratic in a force, 1/2 f' H f - g' f, H positive definite.
struct ForceQuadratic {
  Eigen::Matrix3d h;
  Eigen::Vector3d g;
  double gain(const Eigen::Vector3d& f) const { return g.dot(f) - 0.5 * f.dot(h * f); }
};

// The force in the cone {f: -f.n >= 0, |f + (-f.n) n| <= mu (-f.n)} that makes the quadratic least; zero where every
// push makes it larger. `normal` outward, a unit vector.
Eigen::Vector3d best_push(const ForceQuadratic& quadratic, const Eigen::Vector3d& normal, double mu);

// The same along one direction, a unit vector: s d with s >= 0.
Eigen::Vector3d best_along(const ForceQuadratic& quadratic, const Eigen::Vector3d& direction);

}  // namespace soft_robot_lab
