// SPDX-License-Identifier: BSD-3-Clause
#include "contact_sweep.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mechanics/contact/contact_step.h"
#include "mechanics/solver_constants.h"

namespace soft_robot_lab {

Eigen::Vector3d ContactSweep::Point::at(const Eigen::Matrix3Xd& columns) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int a = 0; a < node_count; ++a)
    sum += shares[static_cast<std::size_t>(a)] * columns.col(nodes[static_cast<std::size_t>(a)]);
  return sum;
}

ContactSweep::ContactSweep(const ContactTerm& contact, const Body& body, const Eigen::Matrix3Xd& inverse_masses_per_kg,
                           const Eigen::Matrix3Xd& positions_m, const ContactState& state)
    : contact_(contact),
      inverse_masses_(inverse_masses_per_kg),
      density_kg_m3_(body.material().density_kg_m3),
      skin_pairs_(static_cast<int>(state.pressures_pa.size())),
      free_(contact.free()),
      points_(touching(positions_m, state)) {}

std::vector<ContactSweep::Point> ContactSweep::touching(const Eigen::Matrix3Xd& positions_m,
                                                        const ContactState& state) const {
  std::vector<Point> points;
  const ContactSums sums = contact_.sums(positions_m, state);
  for (const ContactTouch& touch : sums.touches)
    if (!touch.normal.isZero(0.0)) points.push_back(point_of(touch, positions_m));
  for (const RigidTouch& touch : sums.rigid)
    if (touch.closed || touch.force_n > 0.0) points.push_back(point_of(touch.pair, touch));
  return points;
}

ContactSweep::Point ContactSweep::point_of(const ContactTouch& touch, const Eigen::Matrix3Xd& positions_m) const {
  Point point;
  point.pair = touch.pair;
  if (touch.on_skin())
    point.recovery_m_s = constants::kRecovery * std::sqrt(contact_.skin().youngs_modulus_pa(touch) / density_kg_m3_);
  point.node_count = contact_.nodes_of(touch, point.nodes, point.shares);
  point.pushing = touch.free;
  point.pushing_arm_m = touch.arm_m;
  point.weight_m2 = contact_.weight_m2(touch.pair);
  point.gap_m = touch.gap_m;
  point.compliance_m_n = law_of(contact_, touch).compliance;
  point.push_n = push_n(contact_, touch);
  point.normal = touch.normal;
  point.position_m = point.at(positions_m);
  if (!touch.rubs()) return point;
  point.friction = contact_.friction_of(touch);
  point.tie_m_n = touch.friction.compliance_m_pa / point.weight_m2;
  point.away_m = touch.away_m;
  point.pull_n = point.weight_m2 * touch.friction.traction_pa(touch.away_m);
  return point;
}

ContactSweep::Point ContactSweep::point_of(Eigen::Index rigid_pair, const RigidTouch& touch) const {
  const RigidContact& rigid = contact_.rigid();
  Point point;
  point.pair = skin_pairs_ + static_cast<int>(rigid_pair);
  point.pushed = rigid.free_of(rigid_pair);
  point.pushed_arm_m = touch.arm_m;
  point.pushing = rigid.other_free_of(rigid_pair);
  point.pushing_arm_m = touch.other_arm_m;
  point.gap_m = touch.gap_m;
  point.compliance_m_n = rigid.law_of(rigid_pair).compliance_m_pa;
  point.push_n = touch.force_n;
  point.normal = touch.normal;
  if (!touch.rubs()) return point;
  point.friction = rigid.friction_of(rigid_pair);
  point.tie_m_n = touch.friction.compliance_m_pa;
  point.away_m = touch.along(touch.off_m);
  point.pull_n = touch.traction_n();
  return point;
}

void ContactSweep::weigh(Point& point) const {
  point.inverse_mass_per_kg.setZero();
  for (int a = 0; a < point.node_count; ++a)
    point.inverse_mass_per_kg.diagonal() += point.shares[static_cast<std::size_t>(a)] *
                                            point.shares[static_cast<std::size_t>(a)] *
                                            inverse_masses_.col(point.nodes[static_cast<std::size_t>(a)]);
  if (point.pushed >= 0) point.inverse_mass_per_kg += free_.inverse_mass_per_kg(point.pushed, point.pushed_arm_m);
  if (point.pushing >= 0) point.inverse_mass_per_kg += free_.inverse_mass_per_kg(point.pushing, point.pushing_arm_m);
}

Eigen::Vector3d ContactSweep::way_m(const Point& point, const Eigen::Matrix3Xd& positions_m) const {
  Eigen::Vector3d way_m = point.at(positions_m) - point.position_m;
  if (point.pushed >= 0) way_m += free_.way_m(point.pushed, point.pushed_arm_m);
  if (point.pushing >= 0) way_m -= free_.way_m(point.pushing, point.pushing_arm_m);
  return way_m;
}

Eigen::Vector3d ContactSweep::off_m(const Point& point, const Eigen::Matrix3Xd& positions_m) const {
  return point.along(point.away_m - point.slipped_m + way_m(point, positions_m));
}

// By a force, in the substep.
void ContactSweep::move(const Point& point, const Eigen::Vector3d& force_n, Eigen::Matrix3Xd& positions_m) {
  for (int a = 0; a < point.node_count; ++a) {
    const int node = point.nodes[static_cast<std::size_t>(a)];
    positions_m.col(node) +=
        h_ * h_ * point.shares[static_cast<std::size_t>(a)] * inverse_masses_.col(node).cwiseProduct(force_n);
  }
  if (point.pushed >= 0) free_.push(point.pushed, point.pushed_arm_m, force_n);
  if (point.pushing >= 0) free_.push(point.pushing, point.pushing_arm_m, -force_n);
}

void ContactSweep::begin(double h, const ContactState& state, const FreeVelocities& velocities,
                         Eigen::Matrix3Xd& motion_m) {
  h_ = h;
  free_.begin(h, state.free, velocities);
  for (const Point& point : points_) move(point, point.force_n(), motion_m);
}

// What touches for the first time in this step is tied to where it does.
void ContactSweep::carry_over(const Point& before, Point& point) const {
  const bool known = before.pair == point.pair;
  point.slipped_m = known ? before.slipped_m : point.away_m;
  point.pull_n = known ? point.along(before.pull_n) : Eigen::Vector3d::Zero();
}

void ContactSweep::find(const Eigen::Matrix3Xd& start_m, const Eigen::Matrix3Xd& positions_m, ContactState& state) {
  if (contact_.free().count() > 0) state.free = free_.place();
  const std::vector<Point> before = std::exchange(points_, touching(positions_m, state));
  Point none;
  none.pair = -1;
  auto known = before.begin();
  for (Point& point : points_) {
    weigh(point);
    while (known != before.end() && known->pair < point.pair) ++known;
    carry_over(known != before.end() ? *known : none, point);
    if (point.recovery_m_s < 0.0) continue;
    const double gap_before_m = point.gap_m + point.normal.dot(way_m(point, start_m));
    point.gap_m += std::max(0.0, -gap_before_m - h_ * point.recovery_m_s);
  }
}

void ContactSweep::push(Point& point, Eigen::Matrix3Xd& positions_m) {
  const double weight = h_ * h_ * point.normal.dot(point.inverse_mass_per_kg * point.normal) + point.compliance_m_n;
  const double gap_m = point.gap_m + point.normal.dot(way_m(point, positions_m));
  const double next_n = std::max(0.0, point.push_n - (gap_m + point.compliance_m_n * point.push_n) / weight);
  move(point, (next_n - point.push_n) * point.normal, positions_m);
  point.push_n = next_n;
}

void ContactSweep::rub(Point& point, Eigen::Matrix3Xd& positions_m) {
  const double most_per_kg = point.inverse_mass_per_kg.cwiseAbs().rowwise().sum().maxCoeff();
  const double weight = h_ * h_ * most_per_kg + point.tie_m_n;
  Eigen::Vector3d next_n = point.pull_n + (off_m(point, positions_m) - point.tie_m_n * point.pull_n) / weight;
  const double limit_n = point.friction * point.push_n, wanted_n = next_n.norm();
  if (wanted_n > limit_n) next_n *= limit_n / wanted_n;
  move(point, point.pull_n - next_n, positions_m);
  point.pull_n = next_n;
}

void ContactSweep::sweep(Eigen::Matrix3Xd& positions_m) {
  for (int pass = 0; pass < constants::kContactPasses; ++pass) {
    for (Point& point : points_) {
      push(point, positions_m);
      if (point.tie_m_n > 0.0) rub(point, positions_m);
    }
  }
}

double ContactSweep::finish(const Eigen::Matrix3Xd& start_m, const Eigen::Matrix3Xd& end_m, ContactState& state,
                            FreeVelocities& velocities) {
  double work_j = 0.0;
  state.pressures_pa.setZero();
  state.rigid_forces_n.setZero();
  for (Point& point : points_) {
    double& pressure =
        point.pair < skin_pairs_ ? state.pressures_pa[point.pair] : state.rigid_forces_n[point.pair - skin_pairs_];
    pressure = point.push_n / point.weight_m2;
    work_j += point.force_n().dot(point.at(end_m) - point.at(start_m));
    if (point.tie_m_n == 0.0) continue;
    const bool at_limit = point.pull_n.norm() >= (1.0 - 1e-12) * point.friction * point.push_n;
    if (at_limit) point.slipped_m += off_m(point, end_m) - point.tie_m_n * point.pull_n;
  }
  if (contact_.free().count() == 0) return work_j;
  state.free = free_.place();
  velocities = free_.velocities(state.free);
  return work_j;
}

}  // namespace soft_robot_lab
