// SPDX-License-Identifier: BSD-3-Clause
#include "contact_step.h"

#include <algorithm>

namespace soft_robot_lab {
namespace {

// Closed points push by the pressure that their gap stands for, all others by none.
std::vector<Eigen::Vector3d> mismatch_forces_n(const ContactTerm& contact, const std::vector<ContactTouch>& linearised,
                                               const ContactSums& here) {
  std::vector<Eigen::Vector3d> forces_n;
  auto made = linearised.begin();
  for (const ContactTouch& touch : here.touches) {
    Eigen::Vector3d force_pa = touch.pressure_pa * touch.normal;
    if (touch.closed) {
      while (made != linearised.end() && made->pair < touch.pair) ++made;
      const double off_m = touch.gap_m + contact.law(touch).compliance_m_pa * touch.pressure_pa;
      const bool known = made != linearised.end() && made->pair == touch.pair;
      force_pa = off_m / contact.law(touch).compliance_m_pa * (known ? made->normal : touch.normal);
    }
    forces_n.emplace_back(contact.weight_m2(touch.pair) * force_pa);
  }
  return forces_n;
}

// Along the surface, from its anchor to where a touch of `start` now is.
Eigen::Vector3d away_m(const ContactTerm& contact, const ContactTouch& touch, const ContactSums& start,
                       const ContactSums& now) {
  Eigen::Vector3d away_m = touch.away_m;
  if (touch.on_skin())
    away_m += relative_m(contact.skin(), touch, now.positions_m) - relative_m(contact.skin(), touch, start.positions_m);
  else if (touch.free >= 0)
    away_m = now.points_m.col(contact.point_of(touch.pair)) -
             contact.free().pose(touch.free, now.free) *
                 (contact.free().pose(touch.free, start.free).inverse() * touch.anchor_m);
  else
    away_m = now.points_m.col(contact.point_of(touch.pair)) - touch.anchor_m;
  return away_m - touch.normal * touch.normal.dot(away_m);
}

}  // namespace

bool same_set(const std::vector<ContactTouch>& a, const std::vector<ContactTouch>& b, bool with_skin) {
  const auto next_closed = [&](auto at, auto end) {
    return std::find_if(at, end,
                        [&](const ContactTouch& touch) { return touch.closed && (with_skin || !touch.on_skin()); });
  };
  auto i = next_closed(a.begin(), a.end()), j = next_closed(b.begin(), b.end());
  for (; i != a.end() && j != b.end(); i = next_closed(i + 1, a.end()), j = next_closed(j + 1, b.end())) {
    if (i->pair != j->pair || i->met.face != j->met.face) return false;
  }
  return i == a.end() && j == b.end();
}

void add_mismatch_forces(const ContactTerm& contact, const std::vector<ContactTouch>& linearised,
                         const ContactSums& here, bool with_skin, Eigen::Matrix3Xd& forces_n) {
  const std::vector<Eigen::Vector3d> of_touches = mismatch_forces_n(contact, linearised, here);
  for (std::size_t i = 0; i < of_touches.size(); ++i)
    if (with_skin || !here.touches[i].on_skin()) contact.add_at(here.touches[i], of_touches[i], forces_n);
}

FreeColumns free_mismatch_forces_n(const ContactTerm& contact, const std::vector<ContactTouch>& linearised,
                                   const ContactSums& here) {
  FreeColumns forces = FreeColumns::Zero(3, 2 * contact.free().count());
  const std::vector<Eigen::Vector3d> of_touches = mismatch_forces_n(contact, linearised, here);
  for (std::size_t i = 0; i < of_touches.size(); ++i)
    if (here.touches[i].free >= 0) add_back(here.touches[i], of_touches[i], forces);
  return forces;
}

Eigen::VectorXd next_pressures_pa(const ContactTerm& contact, const std::vector<ContactTouch>& linearised,
                                  const ContactSums& here, bool with_skin, const Eigen::Matrix3Xd& motion_m,
                                  const FreeColumns& free_motion) {
  Eigen::VectorXd next = Eigen::VectorXd::Zero(contact.pair_count());
  auto made = linearised.begin();
  for (const ContactTouch& touch : here.touches) {
    if (!touch.closed || (touch.on_skin() && !with_skin)) continue;
    while (made != linearised.end() && made->pair < touch.pair) ++made;
    const Eigen::Vector3d& normal = made != linearised.end() && made->pair == touch.pair ? made->normal : touch.normal;
    next[touch.pair] = contact.law(touch).pressure_pa(
        touch.gap_m + normal.dot(contact.relative_motion_m(touch, motion_m, free_motion)));
  }
  return next;
}

ConstraintLaw law_of(const ContactTerm& contact, const ContactTouch& touch) {
  ConstraintLaw law;
  law.offset = -touch.gap_m;
  law.compliance = contact.law(touch).compliance_m_pa / contact.weight_m2(touch.pair);
  law.min_multiplier = 0.0;
  return law;
}

std::vector<ContactTouch> met_by(const ContactTerm& contact, const Eigen::Matrix3Xd& motion_m, const ContactSums& end,
                                 const std::vector<ContactTouch>& known) {
  std::vector<ContactTouch> met;
  for (const ContactTouch& touch : end.touches) {
    const auto same = [&](const ContactTouch& other) { return other.pair == touch.pair; };
    if (!touch.on_skin() || std::any_of(known.begin(), known.end(), same)) continue;
    met.push_back(touch);
    met.back().gap_m -= touch.normal.dot(relative_m(contact.skin(), touch, motion_m));
    met.back().pressure_pa = 0.0;
  }
  return met;
}

void add_beyond(const ContactTerm& contact, const std::vector<ContactTouch>& touches, Eigen::Matrix3Xd& residual_n,
                FreeColumns& free) {
  for (const ContactTouch& touch : touches) {
    if (!touch.friction.held) continue;
    const Eigen::Vector3d force_n = contact.weight_m2(touch.pair) * touch.friction.beyond_pa(touch.away_m);
    contact.add_at(touch, force_n, residual_n);
    if (touch.free >= 0) add_back(touch, force_n, free);
  }
}

Eigen::VectorXd mismatches(const ContactTerm& contact, const ContactSums& at, const std::vector<Eigen::Index>& pairs) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto touch = std::lower_bound(at.touches.begin(), at.touches.end(), pairs[i],
                                        [](const ContactTouch& one, Eigen::Index pair) { return one.pair < pair; });
    if (touch != at.touches.end() && touch->pair == pairs[i])
      all[static_cast<Eigen::Index>(i)] =
          contact.law(*touch).mismatch_m(touch->gap_m, touch->pressure_pa) / contact.face_size_m(*touch);
  }
  return all;
}

double merit_j(const ContactTerm& contact, const ContactSums& at, const ContactSums& start,
               const Eigen::VectorXd& next_pressures_pa) {
  double sum = 0.0;
  for (const ContactTouch& touch : at.touches)
    sum += contact.weight_m2(touch.pair) * contact.law(touch).merit_j_m2(touch.gap_m, next_pressures_pa[touch.pair]);
  for (const ContactTouch& touch : start.touches) {
    if (touch.rubs())
      sum += contact.weight_m2(touch.pair) * touch.friction.potential_j_m2(away_m(contact, touch, start, at));
  }
  return sum;
}

double slope_change_j(const ContactTerm& contact, const ContactSums& start, const Eigen::VectorXd& next_pressures_pa,
                      const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion) {
  double sum = 0.0;
  for (const ContactTouch& touch : start.touches) {
    const double push_pa = contact.law(touch).merit_pa(touch.gap_m, next_pressures_pa[touch.pair]);
    sum += contact.weight_m2(touch.pair) * (touch.pressure_pa - push_pa) *
           touch.normal.dot(contact.relative_motion_m(touch, motion_m, free_motion));
  }
  return sum;
}

double soft_energy(const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m, const Eigen::VectorXd& limits_pa,
                   ContactState& state, ContactSums& at) {
  if (contact.empty()) return 0.0;
  state.pressures_pa.setZero();
  at = contact.sums(positions_m, state);
  double sum = 0.0;
  for (ContactTouch& touch : at.touches) {
    const double soft_m_pa = contact.law(touch).soft_m_pa;
    touch.closed = touch.gap_m < 0.0;
    touch.pressure_pa = std::max(0.0, -touch.gap_m / soft_m_pa);
    state.pressures_pa[touch.pair] = touch.pressure_pa;
    sum += 0.5 * contact.weight_m2(touch.pair) * soft_m_pa * touch.pressure_pa * touch.pressure_pa;
    if (!touch.rubs()) continue;
    touch.friction.limit_pa = contact.friction_of(touch) * limits_pa[touch.pair];
    sum += contact.weight_m2(touch.pair) * touch.friction.potential_j_m2(touch.away_m);
  }
  return sum;
}

}  // namespace soft_robot_lab
