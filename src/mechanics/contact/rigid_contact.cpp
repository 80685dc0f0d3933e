// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_contact.h"

#include <algorithm>
#include <cmath>

#include "mechanics/body/gap.h"

namespace soft_robot_lab {
namespace {

using Eigen::Vector3d;
constexpr double kDifference = 1e-6;  // of an obstacle's size: a way over which derivatives are taken

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

// How the motion of a free obstacle takes what moves with it along.
Eigen::Isometry3d moved_about(const Vector3d& center_m, int free, const FreeColumns& motion) {
  return soft_robot_lab::moved_about(center_m, motion.col(2 * free), motion.col(2 * free + 1));
}

// The same pair among touches, which are in order of their pairs; null: it is not near.
const RigidTouch* found(const RigidTouches& all, int pair) {
  const auto at = std::lower_bound(all.begin(), all.end(), pair,
                                   [](const RigidTouch& touch, int index) { return touch.pair < index; });
  return at != all.end() && at->pair == pair ? &*at : nullptr;
}

// With which the matrix was made; its own where the pair was open there.
const Vector3d& normal_of(const RigidTouch& touch, const RigidTouches& linearised) {
  const RigidTouch* known = found(linearised, touch.pair);
  return known && known->closed ? known->normal : touch.normal;
}

}  // namespace

void finish(ContactReading& reading) {
  if (reading.normal_force_n > 0.0) reading.center_m /= reading.normal_force_n;
  reading.normal.normalize();
}

RigidContact::RigidContact(const std::vector<Obstacle>& obstacles, const FreeObstacles& free)
    : obstacles_(obstacles), free_(free) {
  const auto friction = [&](int a, int b) {
    const auto& on = obstacles[static_cast<std::size_t>(a)].friction_on;
    const auto found = on.find(obstacles[static_cast<std::size_t>(b)].name);
    return found == on.end() ? 0.0 : found->second;
  };
  for (int one = 0; one < static_cast<int>(obstacles.size()); ++one) {
    if (free.index_of(one) < 0) continue;
    for (int other = 0; other < static_cast<int>(obstacles.size()); ++other) {
      const int other_free = free.index_of(other);
      if (other == one || (other_free >= 0 && other < one)) continue;
      const Obstacle &own = obstacles[static_cast<std::size_t>(one)],
                     &others = obstacles[static_cast<std::size_t>(other)];
      const double lighter_kg = other_free >= 0 ? std::min(own.mass_kg, others.mass_kg) : own.mass_kg;
      for (const RigidPlace& place : rigid_places(own.shape, others.shape))
        pairs_.push_back({free.index_of(one), one, other, other_free, place, free.size_m(free.index_of(one)),
                          lighter_kg, std::max(friction(one, other), friction(other, one))});
    }
  }
}

// Whether it is the first of all of the same two obstacles.
bool RigidContact::begins(std::size_t pair) const {
  return pair == 0 || pairs_[pair].obstacle != pairs_[pair - 1].obstacle ||
         pairs_[pair].other != pairs_[pair - 1].other;
}

PlacedShape RigidContact::placed(int obstacle, const FreePoses& poses, double time_s) const {
  return {obstacles_[static_cast<std::size_t>(obstacle)].shape, pose(obstacle, poses, time_s)};
}

Eigen::Isometry3d RigidContact::pose(int obstacle, const FreePoses& poses, double time_s) const {
  const int free = free_.index_of(obstacle);
  return free >= 0 ? free_.pose(free, poses) : pose_at(obstacles_[static_cast<std::size_t>(obstacle)], time_s);
}

std::optional<RigidMeeting> RigidContact::meeting(const Pair& pair, const Eigen::Isometry3d& pose,
                                                  const Eigen::Isometry3d& other_pose) const {
  return meet(pair.place, obstacles_[static_cast<std::size_t>(pair.obstacle)].shape, pose,
              obstacles_[static_cast<std::size_t>(pair.other)].shape, other_pose);
}

bool RigidContact::apart(const Pair& pair, const FreePoses& poses, double time_s) const {
  return spheres_apart_m(placed(pair.obstacle, poses, time_s), placed(pair.other, poses, time_s)) > 0.0;
}

// Edges that do not cross are a size away from one another: open.
RigidTouch RigidContact::touch(std::size_t index, const ContactState& state) const {
  const Pair& pair = pairs_[index];
  const auto column = static_cast<Eigen::Index>(index);
  RigidTouch touch;
  touch.pair = static_cast<int>(index);
  touch.force_n = state.rigid_forces_n[column];
  touch.gap_m = pair.size_m;
  touch.pose = pose(pair.obstacle, state.free, state.time_s);
  touch.other_pose = pose(pair.other, state.free, state.time_s);
  const std::optional<RigidMeeting> met = meeting(pair, touch.pose, touch.other_pose);
  if (!met) return touch;
  touch.gap_m = met->gap_m;
  touch.closed = law(pair).closed(touch.gap_m, touch.force_n);
  touch.normal = met->normal;
  touch.bend = met->bend;
  touch.position_m = met->position_m;
  touch.arm_m = touch.position_m - state.free.centers_m.col(pair.free);
  if (pair.other_free >= 0) touch.other_arm_m = touch.position_m - state.free.centers_m.col(pair.other_free);
  if (pair.friction == 0.0) return touch;
  touch.friction = {FrictionLaw::compliance_of_rigid(pair.lighter_kg), pair.friction * touch.force_n};
  touch.off_m = state.rigid_ties_m.col(column) + way_of_free(pair.free, touch.arm_m, state);
  if (pair.other_free >= 0) {
    touch.off_m -= way_of_free(pair.other_free, touch.other_arm_m, state);
  } else {
    const Eigen::Isometry3d before = pose(pair.other, state.free_before, state.before_s);
    touch.off_m += before * (touch.other_pose.inverse() * touch.position_m) - touch.position_m;
  }
  return touch;
}

RigidTouches RigidContact::touches(const ContactState& state) const {
  RigidTouches near;
  bool apart = false;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Pair& pair = pairs_[i];
    if (begins(i)) apart = this->apart(pair, state.free, state.time_s);
    const bool pressed = state.rigid_forces_n[static_cast<Eigen::Index>(i)] > 0.0;
    if (apart && !pressed) continue;
    RigidTouch touch = this->touch(i, state);
    if (pressed || touch.gap_m < pair.size_m) near.push_back(std::move(touch));
  }
  return near;
}

double RigidContact::mismatch(const RigidTouches& at) const {
  double most = 0.0;
  for (const RigidTouch& touch : at) {
    const Pair& pair = pairs_[static_cast<std::size_t>(touch.pair)];
    most = std::max(most, std::abs(law(pair).mismatch_m(touch.gap_m, touch.force_n)) / pair.size_m);
  }
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
  for (const RigidTouch& touch : at)
    add_at(pairs_[static_cast<std::size_t>(touch.pair)], touch, touch.traction_n() - touch.force_n * touch.normal,
           residual);
}

void RigidContact::add_mismatch_forces(const RigidTouches& linearised, const RigidTouches& here,
                                       FreeColumns& residual) const {
  for (const RigidTouch& touch : here) {
    const Pair& pair = pairs_[static_cast<std::size_t>(touch.pair)];
    Vector3d force_n = touch.force_n * touch.normal;
    if (touch.closed) {
      const double compliance = law(pair).compliance_m_pa;
      force_n = (touch.gap_m + compliance * touch.force_n) / compliance * normal_of(touch, linearised);
    }
    add_at(pair, touch, force_n, residual);
  }
}

void RigidContact::add_beyond(const RigidTouches& at, FreeColumns& residual) const {
  for (const RigidTouch& touch : at)
    if (touch.friction.held)
      add_at(pairs_[static_cast<std::size_t>(touch.pair)], touch, touch.friction.beyond_pa(touch.along(touch.off_m)),
             residual);
}

void RigidContact::add_hessian(const RigidTouches& at, bool convex, Eigen::MatrixXd& matrix) const {
  for (const RigidTouch& touch : at) {
    if (!touch.closed) continue;
    const Pair& pair = pairs_[static_cast<std::size_t>(touch.pair)];
    Eigen::Matrix3d block = touch.normal * touch.normal.transpose() / law(pair).compliance_m_pa;
    if (!convex) block -= touch.force_n * touch.bend;
    if (touch.rubs()) block += touch.friction.stiffness_pa_m(touch.along(touch.off_m), touch.normal);
    Eigen::MatrixXd way = Eigen::MatrixXd::Zero(3, matrix.cols());
    way.middleCols<6>(6 * pair.free) = follow(touch.arm_m);
    if (pair.other_free >= 0) way.middleCols<6>(6 * pair.other_free) = -follow(touch.other_arm_m);
    matrix += way.transpose() * block * way;
  }
}

RigidContact::PlaceMotion RigidContact::place_motion(const RigidTouch& touch, const FreeColumns& motion) const {
  const Pair& pair = pairs_[static_cast<std::size_t>(touch.pair)];
  PlaceMotion at{Vector3d::Zero(), way_at(pair.free, touch.arm_m, motion), Vector3d::Zero()};
  const double most = motion.cwiseAbs().maxCoeff();
  const double length = most > 0.0 ? kDifference * std::min(1.0, pair.size_m) / most : 0.0;
  const auto moved_by = [&](double share) {
    Eigen::Isometry3d pose = moved_about(touch.position_m - touch.arm_m, pair.free, share * motion) * touch.pose,
                      other = touch.other_pose;
    if (pair.other_free >= 0)
      other = moved_about(touch.position_m - touch.other_arm_m, pair.other_free, share * motion) * other;
    return meeting(pair, pose, other);
  };
  const std::optional<RigidMeeting> after = moved_by(length), before = moved_by(-length);
  if (length > 0.0 && after && before) {
    at.turn = (after->normal - before->normal) / (2.0 * length);
    at.moves_m = (after->position_m - before->position_m) / (2.0 * length);
  }
  at.along_m = touch.along(relative_motion_m(pair, touch, motion)) - touch.normal * at.turn.dot(touch.off_m) -
               at.turn * touch.normal.dot(touch.off_m);
  return at;
}

void RigidContact::add_slip(const RigidTouch& touch, FreeColumns& residual) const {
  const Vector3d way = touch.along(touch.off_m).normalized();
  add_at(pairs_[static_cast<std::size_t>(touch.pair)], touch, -way / touch.friction.compliance_m_pa, residual);
}

double RigidContact::beyond_limit_m(const RigidTouch& touch, const FreeColumns& motion) const {
  const Pair& pair = pairs_[static_cast<std::size_t>(touch.pair)];
  const double closing_m = touch.normal.dot(relative_motion_m(pair, touch, motion));
  return touch.along(touch.off_m).normalized().dot(place_motion(touch, motion).along_m) +
         pair.friction * touch.friction.compliance_m_pa / law(pair).compliance_m_pa * closing_m;
}

// The normal turns as the ball rolls and the other turns, the tie with it, and the place moves against both centres.
void RigidContact::add_turned(const RigidTouches& at, const FreeColumns& motion, FreeColumns& residual) const {
  for (const RigidTouch& touch : at) {
    if (!touch.closed) continue;
    const Pair& pair = pairs_[static_cast<std::size_t>(touch.pair)];
    const Vector3d relative_m = relative_motion_m(pair, touch, motion);
    const PlaceMotion at_place = place_motion(touch, motion);
    Vector3d more_n = touch.force_n * (touch.bend * relative_m - at_place.turn);
    if (touch.rubs())
      more_n += at_place.along_m / touch.friction.compliance_m_pa -
                touch.friction.stiffness_pa_m(touch.along(touch.off_m), touch.normal) * relative_m;
    add_at(pair, touch, more_n, residual);
    const Vector3d force_n = touch.traction_n() - touch.force_n * touch.normal;
    residual.col(2 * pair.free + 1) += (at_place.moves_m - motion.col(2 * pair.free)).cross(force_n);
    if (pair.other_free >= 0)
      residual.col(2 * pair.other_free + 1) -= (at_place.moves_m - motion.col(2 * pair.other_free)).cross(force_n);
  }
}

bool RigidContact::same_set(const RigidTouches& a, const RigidTouches& b) {
  const auto closed = [](const RigidTouches& all) {
    std::vector<int> pairs;
    for (const RigidTouch& touch : all)
      if (touch.closed) pairs.push_back(touch.pair);
    return pairs;
  };
  return closed(a) == closed(b);
}

Eigen::VectorXd RigidContact::next_forces_n(const RigidTouches& linearised, const RigidTouches& here,
                                            const FreeColumns& motion) const {
  Eigen::VectorXd next = Eigen::VectorXd::Zero(pair_count());
  for (const RigidTouch& touch : here) {
    if (!touch.closed) continue;
    const Pair& pair = pairs_[static_cast<std::size_t>(touch.pair)];
    const double closing_m = normal_of(touch, linearised).dot(relative_motion_m(pair, touch, motion));
    next[touch.pair] = law(pair).pressure_pa(touch.gap_m + closing_m);
  }
  return next;
}

double RigidContact::merit_j(const RigidTouches& at, const RigidTouches& start, const Eigen::VectorXd& next_n) const {
  double sum = 0.0;
  for (const RigidTouch& touch : at) {
    sum += law(pairs_[static_cast<std::size_t>(touch.pair)]).merit_j_m2(touch.gap_m, next_n[touch.pair]);
    const RigidTouch* first = found(start, touch.pair);
    if (first && first->rubs()) sum += first->friction.potential_j_m2(first->along(touch.off_m));
  }
  return sum;
}

double RigidContact::slope_change_j(const RigidTouches& start, const Eigen::VectorXd& next_n,
                                    const FreeColumns& motion) const {
  double sum = 0.0;
  for (const RigidTouch& touch : start) {
    const Pair& pair = pairs_[static_cast<std::size_t>(touch.pair)];
    const double push_n = law(pair).merit_pa(touch.gap_m, next_n[touch.pair]);
    sum += (touch.force_n - push_n) * touch.normal.dot(relative_motion_m(pair, touch, motion));
  }
  return sum;
}

void RigidContact::commit(ContactState& state) const {
  const RigidTouches at = touches(state);
  state.rigid_ties_m.setZero();
  for (const RigidTouch& touch : at)
    if (touch.force_n > 0.0) state.rigid_ties_m.col(touch.pair) = touch.friction.compliance_m_pa * touch.traction_n();
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
  const RigidTouches near = touches(state);
  auto next = near.begin();
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (begins(i)) {
      all.emplace_back();
      all.back().on = obstacles_[static_cast<std::size_t>(pairs_[i].obstacle)].name;
      all.back().surface = obstacles_[static_cast<std::size_t>(pairs_[i].other)].name;
    }
    if (next == near.end() || next->pair != static_cast<int>(i)) continue;
    ContactReading& reading = all.back();
    const RigidTouch& touch = *next++;
    reading.force_n += touch.force_n * touch.normal - touch.traction_n();
    reading.normal_force_n += touch.force_n;
    reading.center_m += touch.force_n * touch.position_m;
    reading.normal += touch.force_n * touch.normal;
    reading.largest_penetration_m = std::max(reading.largest_penetration_m, -touch.gap_m);
  }
  for (ContactReading& reading : all) finish(reading);
  return all;
}

}  // namespace soft_robot_lab
