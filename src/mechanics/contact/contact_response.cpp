// SPDX-License-Identifier: BSD-3-Clause
// What derivatives of a state with contact need besides the matrix.
#include <algorithm>

#include "contact_term.h"

namespace soft_robot_lab {

void ContactTerm::add_slip(const TouchesAtLimit& all, Eigen::Index one, Eigen::Matrix3Xd& residual_n,
                           FreeColumns& free_n) const {
  const auto index = static_cast<std::size_t>(one);
  if (index >= all.points.size()) return rigid_.add_slip(all.rigid[index - all.points.size()], free_n);
  const ContactTouch& touch = all.points[index];
  const Eigen::Vector3d force_n = -weight_m2(touch.pair) / touch.friction.compliance_m_pa * touch.away_m.normalized();
  add_at(touch, force_n, residual_n);
  if (touch.free >= 0) add_back(touch, force_n, free_n);
}

double ContactTerm::beyond_limit_m(const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                                   const FreeColumns& free_motion) const {
  const double coefficient = touch.friction.limit_pa / touch.pressure_pa;
  const Eigen::Vector3d relative_m = relative_motion_m(touch, motion_m, free_motion);
  return touch.away_m.normalized().dot(away_motion_m(touch, relative_m, motion_m, free_motion)) +
         coefficient * touch.friction.compliance_m_pa / law(touch).compliance_m_pa *
             (touch.on_skin() ? skin_.place_motion(touch, relative_m, motion_m).gap_m : touch.normal.dot(relative_m));
}

Eigen::VectorXd ContactTerm::beyond_limits_m(const TouchesAtLimit& all, const Eigen::Matrix3Xd& motion_m,
                                             const FreeColumns& free_motion) const {
  Eigen::VectorXd beyond_m(all.count());
  Eigen::Index i = 0;
  for (const ContactTouch& touch : all.points) beyond_m[i++] = beyond_limit_m(touch, motion_m, free_motion);
  for (const RigidTouch& touch : all.rigid) beyond_m[i++] = rigid_.beyond_limit_m(touch, free_motion);
  return beyond_m;
}

Eigen::VectorXd ContactTerm::limits_n(const TouchesAtLimit& all) const {
  Eigen::VectorXd limits_n(all.count());
  Eigen::Index i = 0;
  for (const ContactTouch& touch : all.points) limits_n[i++] = weight_m2(touch.pair) * touch.friction.limit_pa;
  for (const RigidTouch& touch : all.rigid) limits_n[i++] = touch.friction.limit_pa;
  return limits_n;
}

bool ContactTerm::any_turns(const std::vector<ContactTouch>& touches, const RigidTouches& rigid) const {
  return std::any_of(rigid.begin(), rigid.end(), [](const RigidTouch& touch) { return touch.closed; }) ||
         std::any_of(touches.begin(), touches.end(), [](const ContactTouch& touch) {
           return touch.closed && (touch.free >= 0 || touch.met.at_edge ||
                                   (touch.rubs() && (touch.on_skin() || !touch.bend.isZero(0.0))));
         });
}

// With d(x - y) how the point moves against the surface, and w how that turns: dn = bend d(x - y) + w x n.
Eigen::Vector3d ContactTerm::away_motion_m(const ContactTouch& touch, const Eigen::Vector3d& relative_m,
                                           const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion) const {
  if (touch.on_skin()) return skin_.away_motion_m(touch, relative_m, motion_m);
  Eigen::Vector3d way_m = relative_m, turn = touch.bend * way_m;
  if (touch.free >= 0) {
    const Eigen::Vector3d turn_rad = free_motion.col(2 * touch.free + 1);
    turn += turn_rad.cross(touch.normal);
    way_m += turn_rad.cross(touch.away_m + touch.above_m * touch.normal);
  }
  return touch.along_surface(way_m, turn);
}

void ContactTerm::add_turned_tie(const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                                 const FreeColumns& free_motion, Eigen::Matrix3Xd& residual_n,
                                 FreeColumns& free_n) const {
  const double weight_m2 = this->weight_m2(touch.pair);
  const Eigen::Vector3d relative_m = relative_motion_m(touch, motion_m, free_motion);
  const Eigen::Vector3d in_matrix_pa = touch.friction.stiffness_pa_m(touch.away_m, touch.normal) * relative_m;
  const Eigen::Vector3d away_m = away_motion_m(touch, relative_m, motion_m, free_motion);
  const Eigen::Vector3d force_n = weight_m2 * (away_m / touch.friction.compliance_m_pa - in_matrix_pa);
  add_at(touch, force_n, residual_n);
  if (touch.free >= 0) add_back(touch, force_n, free_n);
  if (touch.on_skin())
    skin_.add_back_moved(touch, relative_m, motion_m, weight_m2 * touch.friction.traction_pa(touch.away_m), residual_n);
}

// Beyond an edge the push has no potential, and the matrix has it as above the face.
void ContactTerm::add_push_at_edge(const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                                   Eigen::Matrix3Xd& residual_n) const {
  const Eigen::Vector3d relative_m = skin_.relative_m(touch, motion_m);
  const SkinContact::PlaceMotion moved = skin_.place_motion(touch, relative_m, motion_m);
  const double per_m = weight_m2(touch.pair) / law(touch).compliance_m_pa;
  add_at(touch, per_m * moved.gap_m * touch.normal - push_n(touch) * moved.turn, residual_n);
  skin_.add_back_moved(touch, relative_m, motion_m, -push_n(touch) * touch.normal, residual_n);
  ContactTouch pushed = touch;
  pushed.friction.limit_pa = -1.0;
  const std::vector<int> nodes = skin_.pairs().nodes(skin_.faces_of(touch));
  const Eigen::VectorXd motion = motion_m(Eigen::all, nodes).reshaped();
  const Eigen::VectorXd in_matrix_n = skin_.hessian(pushed, false, false) * motion;
  for (std::size_t a = 0; a < nodes.size(); ++a)
    residual_n.col(nodes[a]) -= in_matrix_n.segment<3>(3 * static_cast<Eigen::Index>(a));
}

void ContactTerm::add_turned_ties(const std::vector<ContactTouch>& touches, const RigidTouches& rigid,
                                  const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion,
                                  Eigen::Matrix3Xd& residual_n, FreeColumns& free_n) const {
  for (const ContactTouch& touch : touches) {
    if (!touch.closed) continue;
    if (touch.rubs()) add_turned_tie(touch, motion_m, free_motion, residual_n, free_n);
    if (touch.met.at_edge) add_push_at_edge(touch, motion_m, residual_n);
    if (touch.free < 0) continue;
    // The moment of a force whose point moves, of which the matrix has what is symmetric of that of pressure.
    const Eigen::Vector3d turn_rad = free_motion.col(2 * touch.free + 1);
    const Eigen::Vector3d moves_m = points_.at(point_of(touch.pair), motion_m) - free_motion.col(2 * touch.free);
    Eigen::Vector3d traction_pa = Eigen::Vector3d::Zero();
    if (touch.rubs()) traction_pa = touch.friction.traction_pa(touch.away_m);
    free_n.col(2 * touch.free + 1) -=
        weight_m2(touch.pair) *
        (moves_m.cross(traction_pa) + 0.5 * touch.pressure_pa * touch.arm_m.cross(touch.normal).cross(turn_rad));
  }
  rigid_.add_turned(rigid, free_motion, free_n);
}

}  // namespace soft_robot_lab
