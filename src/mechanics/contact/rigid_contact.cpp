// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_contact.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "gap.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;
using Points = std::vector<RoundedPoint>;

constexpr int kOnAxis = 5, kOnEdge = 24;
constexpr double kOverlap = 0.01;  // of an obstacle's size: so deep may it be at the start

Points points(const Plane& /*never free*/) { return {}; }
Points points(const Sphere& sphere) { return {{sphere.center_m, sphere.radius_m}}; }

Points points(const Capsule& capsule) {
  Points all;
  for (int i = 0; i < kOnAxis; ++i)
    all.push_back({capsule.start_m + i / (kOnAxis - 1.0) * (capsule.end_m - capsule.start_m), capsule.radius_m});
  return all;
}

Points points(const Cylinder& cylinder) {
  const Vector3d axis = (cylinder.end_m - cylinder.start_m).normalized(), across = axis.unitOrthogonal();
  Points all;
  for (int i = 0; i < kOnEdge; ++i) {
    const double angle = 2.0 * M_PI * i / kOnEdge;
    const Vector3d outward = std::cos(angle) * across + std::sin(angle) * axis.cross(across);
    const Vector3d off = (cylinder.radius_m - cylinder.rounding_m) * outward;
    all.push_back({cylinder.start_m + cylinder.rounding_m * axis + off, cylinder.rounding_m});
    all.push_back({cylinder.end_m - cylinder.rounding_m * axis + off, cylinder.rounding_m});
  }
  return all;
}

Points points(const RoundedBox& box) {
  Points all;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d sign(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
    all.push_back(
        {box.center_m + sign.cwiseProduct(0.5 * box.size_m - Vector3d::Constant(box.rounding_m)), box.rounding_m});
  }
  return all;
}

// How the material moved, since the step began, past a place that an arm reaches all the while: with a turn the sum of
// small ones, so that its slope is that of the tie's force.
Vector3d way_of_free(int free, const Vector3d& arm_m, const ContactState& state) {
  return state.free.centers_m.col(free) - state.free_before.centers_m.col(free) +
         turned_rad(state.free_before.turns.col(free), state.free.turns.col(free)).cross(arm_m);
}

// How a point of a free obstacle moves with it; and follows its columns.
Vector3d way_at(int free, const Vector3d& arm_m, const FreeColumns& motion) {
  return motion.col(2 * free) + Vector3d(motion.col(2 * free + 1)).cross(arm_m);
}

Eigen::Matrix<double, 3, 6> follow(const Vector3d& arm_m) {
  Eigen::Matrix<double, 3, 6> follow;
  follow.leftCols<3>().setIdentity();
  follow.rightCols<3>() << 0, arm_m.z(), -arm_m.y(), -arm_m.z(), 0, arm_m.x(), arm_m.y(), -arm_m.x(), 0;
  return follow;
}

}  // namespace

Points rounded_points(const ObstacleShape& shape) {
  return std::visit([](const auto& one) { return points(one); }, shape);
}

void finish(ContactReading& reading) {
  if (reading.normal_force_n > 0.0) reading.center_m /= reading.normal_force_n;
  reading.normal.normalize();
}

RigidContact::RigidContact(const std::vector<Obstacle>& obstacles, const FreeObstacles& free, double youngs_modulus_pa)
    : obstacles_(obstacles), free_(free), youngs_modulus_pa_(youngs_modulus_pa) {
  const auto friction = [&](int a, int b) {
    const auto& on = obstacles[static_cast<std::size_t>(a)].friction_on;
    const auto found = on.find(obstacles[static_cast<std::size_t>(b)].name);
    return found == on.end() ? 0.0 : found->second;
  };
  for (int i = 0; i < free.count(); ++i) {
    const int one = free.obstacle(i);
    for (int other = 0; other < static_cast<int>(obstacles.size()); ++other) {
      if (other == one) continue;
      for (const RoundedPoint& point : rounded_points(obstacles[static_cast<std::size_t>(one)].shape))
        pairs_.push_back({i, one, other, free.index_of(other), point, free.size_m(i),
                          std::max(friction(one, other), friction(other, one))});
    }
  }
}

Eigen::Isometry3d RigidContact::pose(int obstacle, const FreePoses& poses, double time_s) const {
  const int free = free_.index_of(obstacle);
  return free >= 0 ? free_.pose(free, poses) : pose_at(obstacles_[static_cast<std::size_t>(obstacle)], time_s);
}

RigidTouch RigidContact::touch(std::size_t index, const ContactState& state) const {
  const Pair& pair = pairs_[index];
  const auto column = static_cast<Eigen::Index>(index);
  const Eigen::Isometry3d own = pose(pair.obstacle, state.free, state.time_s);
  const Eigen::Isometry3d others = pose(pair.other, state.free, state.time_s);
  const Vector3d center_m = own * pair.point.position_m;
  const Gap gap = gap_to(obstacles_[static_cast<std::size_t>(pair.other)].shape, others, center_m);
  RigidTouch touch;
  touch.pair = static_cast<int>(index);
  touch.gap_m = gap.gap_m - pair.point.radius_m;
  touch.force_n = state.rigid_forces_n[column];
  touch.closed = law(pair).closed(touch.gap_m, touch.force_n);
  touch.normal = gap.normal;
  touch.bend = gap.hessian;
  touch.position_m = center_m - pair.point.radius_m * gap.normal;
  touch.arm_m = touch.position_m - state.free.centers_m.col(pair.free);
  if (pair.other_free >= 0) touch.other_arm_m = touch.position_m - state.free.centers_m.col(pair.other_free);
  if (pair.friction == 0.0) return touch;
  touch.friction = {FrictionLaw::compliance_of_skin(pair.size_m, youngs_modulus_pa_), pair.friction * touch.force_n};
  touch.off_m = state.rigid_ties_m.col(column) + way_of_free(pair.free, touch.arm_m, state);
  if (pair.other_free >= 0) {
    touch.off_m -= way_of_free(pair.other_free, touch.other_arm_m, state);
  } else {
    const Eigen::Isometry3d before = pose(pair.other, state.free_before, state.before_s);
    touch.off_m += before * (others.inverse() * touch.position_m) - touch.position_m;
  }
  return touch;
}

RigidTouches RigidContact::touches(const ContactState& state) const {
  RigidTouches all;
  for (std::size_t i = 0; i < pairs_.size(); ++i) all.push_back(touch(i, state));
  return all;
}

double RigidContact::mismatch(const RigidTouches& at) const {
  double most = 0.0;
  for (std::size_t i = 0; i < at.size(); ++i)
    most = std::max(most, std::abs(law(pairs_[i]).mismatch_m(at[i].gap_m, at[i].force_n)) / pairs_[i].size_m);
  return most;
}

Vector3d RigidContact::relative_motion_m(const Pair& pair, const RigidTouch& touch, const FreeColumns& motion) const {
  Vector3d way_m = way_at(pair.free, touch.arm_m, motion);
  if (pair.other_free >= 0) way_m -= way_at(pair.other_free, touch.other_arm_m, motion);
  return way_m;
}

void RigidContact::add_at(const Pair& pair, const RigidTouch& touch, const Vector3d& force_n,
                          FreeColumns& forces) const {
  forces.col(2 * pair.free) += force_n;
  forces.col(2 * pair.free + 1) += touch.arm_m.cross(force_n);
  if (pair.other_free < 0) return;
  forces.col(2 * pair.other_free) -= force_n;
  forces.col(2 * pair.other_free + 1) -= touch.other_arm_m.cross(force_n);
}

void RigidContact::add_forces(const RigidTouches& at, FreeColumns& residual) const {
  for (std::size_t i = 0; i < at.size(); ++i)
    add_at(pairs_[i], at[i], at[i].traction_n() - at[i].force_n * at[i].normal, residual);
}

void RigidContact::add_mismatch_forces(const RigidTouches& linearised, const RigidTouches& here,
                                       FreeColumns& residual) const {
  for (std::size_t i = 0; i < here.size(); ++i) {
    const double compliance = law(pairs_[i]).compliance_m_pa;
    const bool known = linearised[i].closed;
    const Vector3d force_n = here[i].closed ? Vector3d((here[i].gap_m + compliance * here[i].force_n) / compliance *
                                                       (known ? linearised[i].normal : here[i].normal))
                                            : Vector3d(here[i].force_n * here[i].normal);
    add_at(pairs_[i], here[i], force_n, residual);
  }
}

void RigidContact::add_beyond(const RigidTouches& at, FreeColumns& residual) const {
  for (std::size_t i = 0; i < at.size(); ++i)
    if (at[i].friction.held) add_at(pairs_[i], at[i], at[i].friction.beyond_pa(at[i].along(at[i].off_m)), residual);
}

void RigidContact::add_hessian(const RigidTouches& at, bool convex, Eigen::MatrixXd& matrix) const {
  for (std::size_t i = 0; i < at.size(); ++i) {
    const RigidTouch& touch = at[i];
    if (!touch.closed) continue;
    const Pair& pair = pairs_[i];
    Eigen::Matrix3d block = touch.normal * touch.normal.transpose() / law(pair).compliance_m_pa;
    if (!convex) block -= touch.force_n * touch.bend;
    if (touch.rubs()) block += touch.friction.stiffness_pa_m(touch.along(touch.off_m), touch.normal);
    Eigen::MatrixXd way = Eigen::MatrixXd::Zero(3, matrix.cols());
    way.middleCols<6>(6 * pair.free) = follow(touch.arm_m);
    if (pair.other_free >= 0) way.middleCols<6>(6 * pair.other_free) = -follow(touch.other_arm_m);
    matrix += way.transpose() * block * way;
  }
}

Vector3d RigidContact::normal_motion(const Pair& pair, const RigidTouch& touch, const FreeColumns& motion) const {
  const Vector3d to_ball_m = pair.point.radius_m * touch.normal;
  Vector3d way_m = way_at(pair.free, touch.arm_m + to_ball_m, motion);
  if (pair.other_free < 0) return touch.bend * way_m;
  way_m -= way_at(pair.other_free, touch.other_arm_m + to_ball_m, motion);
  return touch.bend * way_m + Vector3d(motion.col(2 * pair.other_free + 1)).cross(touch.normal);
}

Vector3d RigidContact::along_motion_m(const Pair& pair, const RigidTouch& touch, const FreeColumns& motion) const {
  const Vector3d turn = normal_motion(pair, touch, motion);
  return touch.along(relative_motion_m(pair, touch, motion)) - touch.normal * turn.dot(touch.off_m) -
         turn * touch.normal.dot(touch.off_m);
}

void RigidContact::add_slip(const RigidTouch& touch, FreeColumns& residual) const {
  const Vector3d way = touch.along(touch.off_m).normalized();
  add_at(pairs_[static_cast<std::size_t>(touch.pair)], touch, -way / touch.friction.compliance_m_pa, residual);
}

double RigidContact::beyond_limit_m(const RigidTouch& touch, const FreeColumns& motion) const {
  const Pair& pair = pairs_[static_cast<std::size_t>(touch.pair)];
  const double closing_m = touch.normal.dot(relative_motion_m(pair, touch, motion));
  return touch.along(touch.off_m).normalized().dot(along_motion_m(pair, touch, motion)) +
         pair.friction * touch.friction.compliance_m_pa / law(pair).compliance_m_pa * closing_m;
}

// The normal turns as the ball rolls and the other turns, the tie with it, and the place moves against both centres.
void RigidContact::add_turned(const RigidTouches& at, const FreeColumns& motion, FreeColumns& residual) const {
  for (const RigidTouch& touch : at) {
    if (!touch.closed) continue;
    const Pair& pair = pairs_[static_cast<std::size_t>(touch.pair)];
    const Vector3d relative_m = relative_motion_m(pair, touch, motion), turn = normal_motion(pair, touch, motion);
    Vector3d more_n = touch.force_n * (touch.bend * relative_m - turn);
    if (touch.rubs())
      more_n += along_motion_m(pair, touch, motion) / touch.friction.compliance_m_pa -
                touch.friction.stiffness_pa_m(touch.along(touch.off_m), touch.normal) * relative_m;
    add_at(pair, touch, more_n, residual);
    const Vector3d force_n = touch.traction_n() - touch.force_n * touch.normal;
    const Vector3d moves_m =
        way_at(pair.free, touch.arm_m + pair.point.radius_m * touch.normal, motion) - pair.point.radius_m * turn;
    residual.col(2 * pair.free + 1) += (moves_m - motion.col(2 * pair.free)).cross(force_n);
    if (pair.other_free >= 0)
      residual.col(2 * pair.other_free + 1) -= (moves_m - motion.col(2 * pair.other_free)).cross(force_n);
  }
}

bool RigidContact::same_set(const RigidTouches& a, const RigidTouches& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const RigidTouch& one, const RigidTouch& other) { return one.closed == other.closed; });
}

Eigen::VectorXd RigidContact::next_forces_n(const RigidTouches& linearised, const RigidTouches& here,
                                            const FreeColumns& motion) const {
  Eigen::VectorXd next = Eigen::VectorXd::Zero(pair_count());
  for (std::size_t i = 0; i < here.size(); ++i) {
    if (!here[i].closed) continue;
    const Vector3d& normal = linearised[i].closed ? linearised[i].normal : here[i].normal;
    next[static_cast<Eigen::Index>(i)] =
        law(pairs_[i]).pressure_pa(here[i].gap_m + normal.dot(relative_motion_m(pairs_[i], here[i], motion)));
  }
  return next;
}

double RigidContact::merit_j(const RigidTouches& at, const RigidTouches& start, const Eigen::VectorXd& next_n) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    sum += law(pairs_[i]).merit_j_m2(at[i].gap_m, next_n[static_cast<Eigen::Index>(i)]);
    if (start[i].rubs()) sum += start[i].friction.potential_j_m2(start[i].along(at[i].off_m));
  }
  return sum;
}

double RigidContact::slope_change_j(const RigidTouches& start, const Eigen::VectorXd& next_n,
                                    const FreeColumns& motion) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < start.size(); ++i) {
    const double push_n = law(pairs_[i]).merit_pa(start[i].gap_m, next_n[static_cast<Eigen::Index>(i)]);
    sum += (start[i].force_n - push_n) * start[i].normal.dot(relative_motion_m(pairs_[i], start[i], motion));
  }
  return sum;
}

void RigidContact::commit(ContactState& state) const {
  const RigidTouches at = touches(state);
  for (std::size_t i = 0; i < at.size(); ++i)
    state.rigid_ties_m.col(static_cast<Eigen::Index>(i)) =
        at[i].force_n > 0.0 ? Vector3d(at[i].friction.compliance_m_pa * at[i].traction_n()) : Vector3d::Zero();
  state.free_before = state.free;
  state.before_s = state.time_s;
}

double RigidContact::rubbed_j(const RigidTouches& at) const {
  double sum = 0.0;
  for (const RigidTouch& touch : at) {
    if (!touch.rubs() || touch.force_n == 0.0) continue;
    const Vector3d traction_n = touch.traction_n();
    sum += traction_n.dot(touch.along(touch.off_m) - touch.friction.compliance_m_pa * traction_n);
  }
  return sum;
}

std::vector<ContactReading> RigidContact::readings(const ContactState& state) const {
  std::vector<ContactReading> all;
  const RigidTouches at = touches(state);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Pair& pair = pairs_[i];
    const std::string &own = obstacles_[static_cast<std::size_t>(pair.obstacle)].name,
                      &other = obstacles_[static_cast<std::size_t>(pair.other)].name;
    if (all.empty() || all.back().on != own || all.back().surface != other) {
      all.emplace_back();
      all.back().on = own;
      all.back().surface = other;
    }
    ContactReading& reading = all.back();
    reading.force_n += at[i].force_n * at[i].normal - at[i].traction_n();
    reading.normal_force_n += at[i].force_n;
    reading.center_m += at[i].force_n * at[i].position_m;
    reading.normal += at[i].force_n * at[i].normal;
    reading.largest_penetration_m = std::max(reading.largest_penetration_m, -at[i].gap_m);
  }
  for (ContactReading& reading : all) finish(reading);
  return all;
}

void RigidContact::refuse_overlap() const {
  ContactState start;
  start.free = start.free_before = free_.at_start();
  start.rigid_forces_n = Eigen::VectorXd::Zero(pair_count());
  start.rigid_ties_m = Eigen::Matrix3Xd::Zero(3, pair_count());
  const RigidTouches at = touches(start);
  for (std::size_t i = 0; i < at.size(); ++i) {
    if (at[i].gap_m >= -kOverlap * pairs_[i].size_m) continue;
    std::ostringstream text;
    text << "obstacle '" << obstacles_[static_cast<std::size_t>(pairs_[i].obstacle)].name << "' is " << -at[i].gap_m
         << " m inside obstacle '" << obstacles_[static_cast<std::size_t>(pairs_[i].other)].name
         << "' at the start; must be outside";
    throw std::invalid_argument(text.str());
  }
}

}  // namespace soft_robot_lab
