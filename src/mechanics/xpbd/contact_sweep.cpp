// SPDX-License-Identifier: BSD-3-Clause
#include "contact_sweep.h"

#include <algorithm>
#include <utility>

#include "mechanics/solver_constants.h"

namespace soft_robot_lab {

Eigen::Vector3d ContactSweep::Point::at(const Eigen::Matrix3Xd& columns) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int a = 0; a < node_count; ++a)
    sum += shares[static_cast<std::size_t>(a)] * columns.col(nodes[static_cast<std::size_t>(a)]);
  return sum;
}

void ContactSweep::Point::move(const Eigen::Vector3d& force_n, double h, const Eigen::Matrix3Xd& inverse_masses,
                               Eigen::Matrix3Xd& positions_m) const {
  for (int a = 0; a < node_count; ++a) {
    const int node = nodes[static_cast<std::size_t>(a)];
    positions_m.col(node) +=
        h * h * shares[static_cast<std::size_t>(a)] * inverse_masses.col(node).cwiseProduct(force_n);
  }
}

Eigen::Vector3d ContactSweep::Point::off_m(const Eigen::Matrix3Xd& positions_m) const {
  return along(away_m - slipped_m + at(positions_m) - position_m);
}

ContactSweep::Point ContactSweep::point_of(const ContactTouch& touch, const Eigen::Matrix3Xd& positions_m) const {
  Point point;
  point.pair = touch.pair;
  point.node_count = contact_.nodes_of(touch, point.nodes, point.shares);
  point.weight_m2 = contact_.weight_m2(touch.pair);
  point.gap_m = touch.gap_m;
  point.compliance_m_n = contact_.law_of(touch).compliance;
  point.push_n = contact_.push_n(touch);
  point.normal = touch.normal;
  point.position_m = point.at(positions_m);
  point.inverse_mass_per_kg.setZero();
  for (int a = 0; a < point.node_count; ++a)
    point.inverse_mass_per_kg += point.shares[static_cast<std::size_t>(a)] * point.shares[static_cast<std::size_t>(a)] *
                                 inverse_masses_.col(point.nodes[static_cast<std::size_t>(a)]);
  if (!touch.rubs()) return point;
  point.friction = contact_.friction_of(touch);
  point.tie_m_n = touch.friction.compliance_m_pa / point.weight_m2;
  point.away_m = touch.away_m;
  return point;
}

ContactSweep::ContactSweep(const ContactTerm& contact, const Eigen::Matrix3Xd& inverse_masses_per_kg,
                           const Eigen::Matrix3Xd& positions_m, const ContactState& state)
    : contact_(contact), inverse_masses_(inverse_masses_per_kg) {
  for (const ContactTouch& touch : contact.sums(positions_m, state).touches) {
    if (touch.normal.isZero(0.0)) continue;
    points_.push_back(point_of(touch, positions_m));
    if (touch.rubs()) points_.back().pull_n = points_.back().weight_m2 * touch.friction.traction_pa(touch.away_m);
  }
}

void ContactSweep::add_motion(double h, Eigen::Matrix3Xd& motion_m) const {
  for (const Point& point : points_) point.move(point.force_n(), h, inverse_masses_, motion_m);
}

// What touches for the first time in this step is tied to where it does.
void ContactSweep::find(const Eigen::Matrix3Xd& positions_m, const ContactState& state) {
  const std::vector<Point> before = std::exchange(points_, {});
  auto known = before.begin();
  for (const ContactTouch& touch : contact_.sums(positions_m, state).touches) {
    if (touch.normal.isZero(0.0)) continue;
    Point point = point_of(touch, positions_m);
    while (known != before.end() && known->pair < touch.pair) ++known;
    if (known != before.end() && known->pair == touch.pair) {
      point.slipped_m = known->slipped_m;
      point.pull_n = point.along(known->pull_n);
    } else {
      point.slipped_m = point.away_m;
    }
    points_.push_back(point);
  }
}

void ContactSweep::push(Point& point, double h, Eigen::Matrix3Xd& positions_m) const {
  const double weight = h * h * point.inverse_mass_per_kg.dot(point.normal.cwiseAbs2()) + point.compliance_m_n;
  const double gap_m = point.gap_m + point.normal.dot(point.at(positions_m) - point.position_m);
  const double next_n = std::max(0.0, point.push_n - (gap_m + point.compliance_m_n * point.push_n) / weight);
  point.move((next_n - point.push_n) * point.normal, h, inverse_masses_, positions_m);
  point.push_n = next_n;
}

void ContactSweep::rub(Point& point, double h, Eigen::Matrix3Xd& positions_m) const {
  const double weight = h * h * point.inverse_mass_per_kg.maxCoeff() + point.tie_m_n;
  Eigen::Vector3d next_n = point.pull_n + (point.off_m(positions_m) - point.tie_m_n * point.pull_n) / weight;
  const double limit_n = point.friction * point.push_n, wanted_n = next_n.norm();
  if (wanted_n > limit_n) next_n *= limit_n / wanted_n;
  point.move(point.pull_n - next_n, h, inverse_masses_, positions_m);
  point.pull_n = next_n;
}

void ContactSweep::sweep(double h, Eigen::Matrix3Xd& positions_m) {
  for (int pass = 0; pass < constants::kContactPasses; ++pass) {
    for (Point& point : points_) {
      push(point, h, positions_m);
      if (point.tie_m_n > 0.0) rub(point, h, positions_m);
    }
  }
}

double ContactSweep::finish(const Eigen::Matrix3Xd& start_m, const Eigen::Matrix3Xd& end_m, bool slips,
                            ContactState& state) {
  double work_j = 0.0;
  state.pressures_pa.setZero();
  for (Point& point : points_) {
    state.pressures_pa[point.pair] = point.push_n / point.weight_m2;
    work_j += point.force_n().dot(point.at(end_m) - point.at(start_m));
    if (point.tie_m_n == 0.0) continue;
    const bool at_limit = point.pull_n.norm() >= (1.0 - 1e-12) * point.friction * point.push_n;
    if (slips && at_limit) point.slipped_m += point.off_m(end_m) - point.tie_m_n * point.pull_n;
    if (!slips) point.slipped_m.setZero();
  }
  return work_j;
}

}  // namespace soft_robot_lab
