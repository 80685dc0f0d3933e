// SPDX-License-Identifier: BSD-3-Clause
#include "contact_response.h"

#include <algorithm>

#include "contact_step.h"
#include "skin_motion.h"

namespace soft_robot_lab {
namespace {

// With d(x - y) how the point moves against the surface, and w how that turns: dn = bend d(x - y) + w x n.
Eigen::Vector3d away_motion_m(const ContactTerm& contact, const ContactTouch& touch, const Eigen::Vector3d& relative_m,
                              const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion) {
  if (touch.on_skin()) return away_motion_m(contact.skin(), touch, relative_m, motion_m);
  Eigen::Vector3d way_m = relative_m, turn = touch.bend * way_m;
  if (touch.free >= 0) {
    const Eigen::Vector3d turn_rad = free_motion.col(2 * touch.free + 1);
    turn += turn_rad.cross(touch.normal);
    way_m += turn_rad.cross(touch.away_m + touch.above_m * touch.normal);
  }
  return touch.along_surface(way_m, turn);
}

double beyond_limit_m(const ContactTerm& contact, const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                      const FreeColumns& free_motion) {
  const double coefficient = touch.friction.limit_pa / touch.pressure_pa;
  const Eigen::Vector3d relative_m = contact.relative_motion_m(touch, motion_m, free_motion);
  return touch.away_m.normalized().dot(away_motion_m(contact, touch, relative_m, motion_m, free_motion)) +
         coefficient * touch.friction.compliance_m_pa / contact.law(touch).compliance_m_pa *
             (touch.on_skin() ? place_motion(contact.skin(), touch, relative_m, motion_m).gap_m
                              : touch.normal.dot(relative_m));
}

void add_turned_tie(const ContactTerm& contact, const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                    const FreeColumns& free_motion, Eigen::Matrix3Xd& residual_n, FreeColumns& free_n) {
  const double weight_m2 = contact.weight_m2(touch.pair);
  const Eigen::Vector3d relative_m = contact.relative_motion_m(touch, motion_m, free_motion);
  const Eigen::Vector3d in_matrix_pa = touch.friction.stiffness_pa_m(touch.away_m, touch.normal) * relative_m;
  const Eigen::Vector3d away_m = away_motion_m(contact, touch, relative_m, motion_m, free_motion);
  const Eigen::Vector3d force_n = weight_m2 * (away_m / touch.friction.compliance_m_pa - in_matrix_pa);
  contact.add_at(touch, force_n, residual_n);
  if (touch.free >= 0) add_back(touch, force_n, free_n);
  if (touch.on_skin())
    add_back_moved(contact.skin(), touch, relative_m, motion_m, weight_m2 * touch.friction.traction_pa(touch.away_m),
                   residual_n);
}

// Beyond an edge the push has no potential, and the matrix has it as above the face.
void add_push_at_edge(const ContactTerm& contact, const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                      Eigen::Matrix3Xd& residual_n) {
  const Eigen::Vector3d relative_m = soft_robot_lab::relative_m(contact.skin(), touch, motion_m);
  const SkinPlaceMotion moved = place_motion(contact.skin(), touch, relative_m, motion_m);
  const double per_m = contact.weight_m2(touch.pair) / contact.law(touch).compliance_m_pa;
  contact.add_at(touch, per_m * moved.gap_m * touch.normal - push_n(contact, touch) * moved.turn, residual_n);
  add_back_moved(contact.skin(), touch, relative_m, motion_m, -push_n(contact, touch) * touch.normal, residual_n);
  ContactTouch pushed = touch;
  pushed.friction.limit_pa = -1.0;
  const std::vector<int> nodes = contact.skin().pairs().nodes(contact.skin().faces_of(touch));
  const Eigen::VectorXd motion = motion_m(Eigen::all, nodes).reshaped();
  const Eigen::VectorXd in_matrix_n = contact.skin().hessian(pushed, false, false) * motion;
  for (std::size_t a = 0; a < nodes.size(); ++a)
    residual_n.col(nodes[a]) -= in_matrix_n.segment<3>(3 * static_cast<Eigen::Index>(a));
}

}  // namespace

void add_slip(const ContactTerm& contact, const TouchesAtLimit& all, Eigen::Index one, Eigen::Matrix3Xd& residual_n,
              FreeColumns& free_n) {
  const auto index = static_cast<std::size_t>(one);
  if (index >= all.points.size()) return contact.rigid().add_slip(all.rigid[index - all.points.size()], free_n);
  const ContactTouch& touch = all.points[index];
  const Eigen::Vector3d force_n =
      -contact.weight_m2(touch.pair) / touch.friction.compliance_m_pa * touch.away_m.normalized();
  contact.add_at(touch, force_n, residual_n);
  if (touch.free >= 0) add_back(touch, force_n, free_n);
}

Eigen::VectorXd beyond_limits_m(const ContactTerm& contact, const TouchesAtLimit& all, const Eigen::Matrix3Xd& motion_m,
                                const FreeColumns& free_motion) {
  Eigen::VectorXd beyond_m(all.count());
  Eigen::Index i = 0;
  for (const ContactTouch& touch : all.points) beyond_m[i++] = beyond_limit_m(contact, touch, motion_m, free_motion);
  for (const RigidTouch& touch : all.rigid) beyond_m[i++] = contact.rigid().beyond_limit_m(touch, free_motion);
  return beyond_m;
}

Eigen::VectorXd limits_n(const ContactTerm& contact, const TouchesAtLimit& all) {
  Eigen::VectorXd limits_n(all.count());
  Eigen::Index i = 0;
  for (const ContactTouch& touch : all.points) limits_n[i++] = contact.weight_m2(touch.pair) * touch.friction.limit_pa;
  for (const RigidTouch& touch : all.rigid) limits_n[i++] = touch.friction.limit_pa;
  return limits_n;
}

bool any_turns(const std::vector<ContactTouch>& touches, const RigidTouches& rigid) {
  return std::any_of(rigid.begin(), rigid.end(), [](const RigidTouch& touch) { return touch.closed; }) ||
         std::any_of(touches.begin(), touches.end(), [](const ContactTouch& touch) {
           return touch.closed && (touch.free >= 0 || touch.met.at_edge ||
                                   (touch.rubs() && (touch.on_skin() || !touch.bend.isZero(0.0))));
         });
}

void add_turned_ties(const ContactTerm& contact, const std::vector<ContactTouch>& touches, const RigidTouches& rigid,
                     const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion, Eigen::Matrix3Xd& residual_n,
                     FreeColumns& free_n) {
  for (const ContactTouch& touch : touches) {
    if (!touch.closed) continue;
    if (touch.rubs()) add_turned_tie(contact, touch, motion_m, free_motion, residual_n, free_n);
    if (touch.met.at_edge) add_push_at_edge(contact, touch, motion_m, residual_n);
    if (touch.free < 0) continue;
    // The moment of a force whose point moves, of which the matrix has what is symmetric of that of pressure.
    const Eigen::Vector3d turn_rad = free_motion.col(2 * touch.free + 1);
    const Eigen::Vector3d moves_m =
        contact.points().at(contact.point_of(touch.pair), motion_m) - free_motion.col(2 * touch.free);
    Eigen::Vector3d traction_pa = Eigen::Vector3d::Zero();
    if (touch.rubs()) traction_pa = touch.friction.traction_pa(touch.away_m);
    free_n.col(2 * touch.free + 1) -=
        contact.weight_m2(touch.pair) *
        (moves_m.cross(traction_pa) + 0.5 * touch.pressure_pa * touch.arm_m.cross(touch.normal).cross(turn_rad));
  }
  contact.rigid().add_turned(rigid, free_motion, free_n);
}

double rubbed_j(const ContactTerm& contact, const ContactSums& at) {
  double sum = contact.rigid().rubbed_j(at.rigid);
  for (const ContactTouch& touch : at.touches) {
    if (!touch.rubs() || touch.pressure_pa == 0.0) continue;
    const Eigen::Vector3d traction_pa = touch.friction.traction_pa(touch.away_m);
    sum += contact.weight_m2(touch.pair) * traction_pa.dot(touch.away_m - touch.friction.compliance_m_pa * traction_pa);
  }
  return sum;
}

}  // namespace soft_robot_lab
