// SPDX-License-Identifier: BSD-3-Clause
// Coulomb friction of a contact point as elasticity and plasticity (Wriggers 2006, 5.2): the point is tied to an anchor
// by a compliance, and drags it along where the traction reaches its limit, coefficient times pressure. With the limit
// held fixed the traction has a convex potential that is C1, so a line search can trust it.
#pragma once

#include <algorithm>

#include <Eigen/Core>

namespace soft_robot_lab {

struct FrictionLaw {
  double compliance_m_pa = 0.0;  // of the tie
  double limit_pa = 0.0;         // of the traction
  bool secant = false;           // stiffness_pa_m is that of a parabola over the potential, which no step overshoots
  bool held = false;             // it is that of the tie, wherever the limit is

  static double compliance_of_skin(double face_size_m, double youngs_modulus_pa) {
    return 0.02 * face_size_m / youngs_modulus_pa;
  }

  // Of rigid things, with forces for tractions: as that of NormalLaw::of_rigid, ten times as soft.
  static double compliance_of_rigid(double lighter_kg) { return 1e-8 / lighter_kg; }

  bool slips(const Eigen::Vector3d& away_m) const { return away_m.norm() > limit_pa * compliance_m_pa; }

  // Whether it slips, or has: an anchor that was dragged along is just at the limit, on other skin nearly.
  bool at_limit(const Eigen::Vector3d& away_m) const { return slips((1.0 + 1e-3) * away_m); }

  // Traction against which the point stands `away_m` from its anchor, along the obstacle's surface.
  Eigen::Vector3d traction_pa(const Eigen::Vector3d& away_m) const {
    if (!slips(away_m)) return away_m / compliance_m_pa;
    return limit_pa / away_m.norm() * away_m;
  }

  // What the tie would pull more than that if it held.
  Eigen::Vector3d beyond_pa(const Eigen::Vector3d& away_m) const {
    return away_m / compliance_m_pa - traction_pa(away_m);
  }

  double potential_j_m2(const Eigen::Vector3d& away_m) const {
    if (!slips(away_m)) return 0.5 * away_m.squaredNorm() / compliance_m_pa;
    return limit_pa * (away_m.norm() - 0.5 * limit_pa * compliance_m_pa);
  }

  // Second derivative in the plane of this normal, or a secant in its place. A point that has no pressure yet counts as
  // sticking: a body that has just touched would drift away else.
  Eigen::Matrix3d stiffness_pa_m(const Eigen::Vector3d& away_m, const Eigen::Vector3d& normal) const {
    const Eigen::Matrix3d plane = Eigen::Matrix3d::Identity() - normal * normal.transpose();
    if (held || limit_pa == 0.0 || !slips(away_m)) return plane / compliance_m_pa;
    if (secant) return limit_pa / away_m.norm() * plane;
    const Eigen::Vector3d along = away_m.normalized();
    return limit_pa / away_m.norm() * (plane - along * along.transpose());
  }
};

}  // namespace soft_robot_lab
