// SPDX-License-Identifier: BSD-3-Clause
// What derivatives of a state with contact need besides the matrix.
#include <algorithm>

#include "contact_term.h"

namespace soft_robot_lab {

void ContactTerm::add_slip(const ContactTouch& touch, Eigen::Matrix3Xd& residual_n, FreeColumns& free_n) const {
  const Eigen::Vector3d force_n = -weight_m2(touch.pair) * touch.away_m.normalized();
  add_at(touch, force_n, residual_n);
  if (touch.free >= 0) add_back(touch, force_n, free_n);
}

double ContactTerm::beyond_limit_pa(const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                                    const FreeColumns& free_motion) const {
  const double coefficient = touch.friction.limit_pa / touch.pressure_pa;
  return touch.away_m.normalized().dot(away_motion_m(touch, motion_m, free_motion)) / touch.friction.compliance_m_pa +
         coefficient * touch.normal.dot(relative_motion_m(touch, motion_m, free_motion)) /
             law(touch.pair).compliance_m_pa;
}

bool ContactTerm::any_turns(const std::vector<ContactTouch>& touches) const {
  return std::any_of(touches.begin(), touches.end(), [](const ContactTouch& touch) {
    return touch.closed && (touch.free >= 0 || (touch.rubs() && (touch.on_skin() || !touch.bend.isZero(0.0))));
  });
}

// With d(x - y) how the point moves against the surface, and w how that turns: dn = bend d(x - y) + w x n.
Eigen::Vector3d ContactTerm::away_motion_m(const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                                           const FreeColumns& free_motion) const {
  if (touch.on_skin()) return skin_.away_motion_m(touch, motion_m);
  Eigen::Vector3d way_m = relative_motion_m(touch, motion_m, free_motion), turn = touch.bend * way_m;
  if (touch.free >= 0) {
    const Eigen::Vector3d turn_rad = free_motion.col(2 * touch.free + 1);
    turn += turn_rad.cross(touch.normal);
    way_m += turn_rad.cross(touch.away_m + touch.above_m * touch.normal);
  }
  return touch.along_surface(way_m, turn);
}

void ContactTerm::add_turned_ties(const std::vector<ContactTouch>& touches, const Eigen::Matrix3Xd& motion_m,
                                  const FreeColumns& free_motion, Eigen::Matrix3Xd& residual_n,
                                  FreeColumns& free_n) const {
  for (const ContactTouch& touch : touches) {
    if (!touch.closed) continue;
    const double weight_m2 = this->weight_m2(touch.pair);
    Eigen::Vector3d traction_pa = Eigen::Vector3d::Zero();
    if (touch.rubs()) {
      const Eigen::Vector3d in_matrix_pa =
          touch.friction.stiffness_pa_m(touch.away_m, touch.normal) * relative_motion_m(touch, motion_m, free_motion);
      const Eigen::Vector3d force_n =
          weight_m2 * (away_motion_m(touch, motion_m, free_motion) / touch.friction.compliance_m_pa - in_matrix_pa);
      traction_pa = touch.friction.traction_pa(touch.away_m);
      add_at(touch, force_n, residual_n);
      if (touch.free >= 0) add_back(touch, force_n, free_n);
      if (touch.on_skin()) skin_.add_back_moved(touch, motion_m, weight_m2 * traction_pa, residual_n);
    }
    if (touch.free < 0) continue;
    // The moment of a force whose point moves, of which the matrix has what is symmetric of that of pressure.
    const Eigen::Vector3d turn_rad = free_motion.col(2 * touch.free + 1);
    const Eigen::Vector3d moves_m = points_.at(point_of(touch.pair), motion_m) - free_motion.col(2 * touch.free);
    free_n.col(2 * touch.free + 1) -=
        weight_m2 *
        (moves_m.cross(traction_pa) + 0.5 * touch.pressure_pa * touch.arm_m.cross(touch.normal).cross(turn_rad));
  }
}

}  // namespace soft_robot_lab
