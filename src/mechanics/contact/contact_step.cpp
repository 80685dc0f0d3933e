// SPDX-License-Identifier: BSD-3-Clause
// Contact in a step of Newton's method: its condensation, where it leads, and its merit.
#include <algorithm>

#include "contact_term.h"

namespace soft_robot_lab {

bool ContactTerm::same_set(const std::vector<ContactTouch>& a, const std::vector<ContactTouch>& b, bool with_skin) {
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

// Closed points push by the pressure that their gap stands for, all others by none.
std::vector<Eigen::Vector3d> ContactTerm::mismatch_forces_n(const std::vector<ContactTouch>& linearised,
                                                            const ContactSums& here) const {
  std::vector<Eigen::Vector3d> forces_n;
  auto made = linearised.begin();
  for (const ContactTouch& touch : here.touches) {
    Eigen::Vector3d force_pa = touch.pressure_pa * touch.normal;
    if (touch.closed) {
      while (made != linearised.end() && made->pair < touch.pair) ++made;
      const double off_m = touch.gap_m + law(touch).compliance_m_pa * touch.pressure_pa;
      const bool known = made != linearised.end() && made->pair == touch.pair;
      force_pa = off_m / law(touch).compliance_m_pa * (known ? made->normal : touch.normal);
    }
    forces_n.emplace_back(weight_m2(touch.pair) * force_pa);
  }
  return forces_n;
}

void ContactTerm::add_mismatch_forces(const std::vector<ContactTouch>& linearised, const ContactSums& here,
                                      bool with_skin, Eigen::Matrix3Xd& forces_n) const {
  const std::vector<Eigen::Vector3d> of_touches = mismatch_forces_n(linearised, here);
  for (std::size_t i = 0; i < of_touches.size(); ++i)
    if (with_skin || !here.touches[i].on_skin()) add_at(here.touches[i], of_touches[i], forces_n);
}

FreeColumns ContactTerm::free_mismatch_forces_n(const std::vector<ContactTouch>& linearised,
                                                const ContactSums& here) const {
  FreeColumns forces = FreeColumns::Zero(3, 2 * free_.count());
  const std::vector<Eigen::Vector3d> of_touches = mismatch_forces_n(linearised, here);
  for (std::size_t i = 0; i < of_touches.size(); ++i)
    if (here.touches[i].free >= 0) add_back(here.touches[i], of_touches[i], forces);
  return forces;
}

Eigen::VectorXd ContactTerm::next_pressures_pa(const std::vector<ContactTouch>& linearised, const ContactSums& here,
                                               bool with_skin, const Eigen::Matrix3Xd& motion_m,
                                               const FreeColumns& free_motion) const {
  Eigen::VectorXd next = Eigen::VectorXd::Zero(pair_count());
  auto made = linearised.begin();
  for (const ContactTouch& touch : here.touches) {
    if (!touch.closed || (touch.on_skin() && !with_skin)) continue;
    while (made != linearised.end() && made->pair < touch.pair) ++made;
    const Eigen::Vector3d& normal = made != linearised.end() && made->pair == touch.pair ? made->normal : touch.normal;
    next[touch.pair] =
        law(touch).pressure_pa(touch.gap_m + normal.dot(relative_motion_m(touch, motion_m, free_motion)));
  }
  return next;
}

ConstraintLaw ContactTerm::law_of(const ContactTouch& touch) const {
  ConstraintLaw law;
  law.offset = -touch.gap_m;
  law.compliance = this->law(touch).compliance_m_pa / weight_m2(touch.pair);
  law.min_multiplier = 0.0;
  return law;
}

std::vector<ContactTouch> ContactTerm::met_by(const Eigen::Matrix3Xd& motion_m, const ContactSums& end,
                                              const std::vector<ContactTouch>& known) const {
  std::vector<ContactTouch> met;
  for (const ContactTouch& touch : end.touches) {
    const auto same = [&](const ContactTouch& other) { return other.pair == touch.pair; };
    if (!touch.on_skin() || std::any_of(known.begin(), known.end(), same)) continue;
    met.push_back(touch);
    met.back().gap_m -= touch.normal.dot(skin_.relative_m(touch, motion_m));
    met.back().pressure_pa = 0.0;
  }
  return met;
}

void ContactTerm::add_beyond(const std::vector<ContactTouch>& touches, Eigen::Matrix3Xd& residual_n,
                             FreeColumns& free) const {
  for (const ContactTouch& touch : touches) {
    if (!touch.friction.held) continue;
    const Eigen::Vector3d force_n = weight_m2(touch.pair) * touch.friction.beyond_pa(touch.away_m);
    add_at(touch, force_n, residual_n);
    if (touch.free >= 0) add_back(touch, force_n, free);
  }
}

Eigen::VectorXd ContactTerm::mismatches(const ContactSums& at, const std::vector<Eigen::Index>& pairs) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto touch = std::lower_bound(at.touches.begin(), at.touches.end(), pairs[i],
                                        [](const ContactTouch& one, Eigen::Index pair) { return one.pair < pair; });
    if (touch != at.touches.end() && touch->pair == pairs[i])
      all[static_cast<Eigen::Index>(i)] =
          law(*touch).mismatch_m(touch->gap_m, touch->pressure_pa) / face_size_m(*touch);
  }
  return all;
}

double ContactTerm::merit_j(const ContactSums& at, const ContactSums& start,
                            const Eigen::VectorXd& next_pressures_pa) const {
  double sum = 0.0;
  for (const ContactTouch& touch : at.touches)
    sum += weight_m2(touch.pair) * law(touch).merit_j_m2(touch.gap_m, next_pressures_pa[touch.pair]);
  for (const ContactTouch& touch : start.touches) {
    if (touch.rubs()) sum += weight_m2(touch.pair) * touch.friction.potential_j_m2(away_m(touch, start, at));
  }
  return sum;
}

double ContactTerm::slope_change_j(const ContactSums& start, const Eigen::VectorXd& next_pressures_pa,
                                   const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion) const {
  double sum = 0.0;
  for (const ContactTouch& touch : start.touches) {
    const double push_pa = law(touch).merit_pa(touch.gap_m, next_pressures_pa[touch.pair]);
    sum += weight_m2(touch.pair) * (touch.pressure_pa - push_pa) *
           touch.normal.dot(relative_motion_m(touch, motion_m, free_motion));
  }
  return sum;
}

double ContactTerm::soft_energy(const Eigen::Matrix3Xd& positions_m, const Eigen::VectorXd& limits_pa,
                                ContactState& state, ContactSums& at) const {
  if (empty()) return 0.0;
  state.pressures_pa.setZero();
  at = sums(positions_m, state);
  double sum = 0.0;
  for (ContactTouch& touch : at.touches) {
    const double soft_m_pa = law(touch).soft_m_pa;
    touch.closed = touch.gap_m < 0.0;
    touch.pressure_pa = std::max(0.0, -touch.gap_m / soft_m_pa);
    state.pressures_pa[touch.pair] = touch.pressure_pa;
    sum += 0.5 * weight_m2(touch.pair) * soft_m_pa * touch.pressure_pa * touch.pressure_pa;
    if (!touch.rubs()) continue;
    touch.friction.limit_pa = friction_of(touch) * limits_pa[touch.pair];
    sum += weight_m2(touch.pair) * touch.friction.potential_j_m2(touch.away_m);
  }
  return sum;
}

}  // namespace soft_robot_lab
