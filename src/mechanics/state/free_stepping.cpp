// SPDX-License-Identifier: BSD-3-Clause
#include "free_stepping.h"

#include <algorithm>

#include <Eigen/LU>

namespace soft_robot_lab {

FreeStep::FreeStep(const FreeObstacles& free, const SimulationState& before, const BackwardDifference& difference)
    : free_(free), gamma_s_(difference.gamma_s) {
  if (free.count() == 0) return;
  auto inertia = std::make_shared<FreeInertia>();
  const double now = difference.weight_now, past = difference.weight_before;
  const bool history = past > 0.0;
  inertia->per_s2 = 1.0 / (gamma_s_ * gamma_s_);
  inertia->start = before.contact.free;
  centers_from_m_ = now * before.contact.free.centers_m;
  turns_from_rad_ = Eigen::Matrix3Xd::Zero(3, free.count());
  Eigen::Matrix3Xd velocities_from_m_s = now * before.free_velocities.linear_m_s;
  if (history) {
    centers_from_m_ -= past * before.previous_free.centers_m;
    velocities_from_m_s -= past * before.previous_free_velocities.linear_m_s;
  }
  if (difference.trapezoidal) {
    centers_from_m_ += gamma_s_ * before.free_velocities.linear_m_s;
    turns_from_rad_ = gamma_s_ * before.free_velocities.angular_rad_s;
    for (int i = 0; i < free.count(); ++i)
      velocities_from_m_s.col(i) += gamma_s_ / free.mass_kg(i) * before.free_forces_n.col(2 * i);
  }
  inertia->predicted_m = centers_from_m_ + gamma_s_ * velocities_from_m_s;
  inertia->predicted_rad.resize(3, free.count());
  for (int i = 0; i < free.count(); ++i) {
    const Eigen::Vector4d turn = before.contact.free.turns.col(i);
    const Eigen::Matrix3d inertia_now = free.inertia_kg_m2(i, turn);
    Eigen::Vector3d momentum_from = now * inertia_now * before.free_velocities.angular_rad_s.col(i);
    if (history) {
      const Eigen::Vector4d was = before.previous_free.turns.col(i);
      turns_from_rad_.col(i) = -past * turned_rad(turn, was);
      momentum_from -= past * free.inertia_kg_m2(i, was) * before.previous_free_velocities.angular_rad_s.col(i);
    }
    if (difference.trapezoidal) momentum_from += gamma_s_ * before.free_forces_n.col(2 * i + 1);
    const Eigen::Vector3d guess_rad = turns_from_rad_.col(i) + gamma_s_ * inertia_now.inverse() * momentum_from;
    inertia->kg_m2.push_back(free.inertia_kg_m2(i, turn_by(guess_rad, turn)));
    inertia->predicted_rad.col(i) = turns_from_rad_.col(i) + gamma_s_ * inertia->kg_m2.back().inverse() * momentum_from;
  }
  inertia_ = std::move(inertia);
}

FreePoses FreeStep::predicted() const {
  if (!inertia_) return {};
  FreeColumns way(3, 2 * free_.count());
  for (int i = 0; i < free_.count(); ++i) {
    way.col(2 * i) = inertia_->predicted_m.col(i) - inertia_->start.centers_m.col(i);
    way.col(2 * i + 1) = inertia_->predicted_rad.col(i);
  }
  return moved(inertia_->start, way);
}

FreeVelocities FreeStep::velocities(const FreePoses& end) const {
  FreeVelocities velocities;
  if (!inertia_) return velocities;
  velocities.linear_m_s = (end.centers_m - centers_from_m_) / gamma_s_;
  velocities.angular_rad_s.resize(3, free_.count());
  for (int i = 0; i < free_.count(); ++i) {
    const Eigen::Vector3d turn_rad = turned_rad(inertia_->start.turns.col(i), end.turns.col(i));
    const Eigen::Vector3d momentum =
        inertia_->kg_m2[static_cast<std::size_t>(i)] * (turn_rad - turns_from_rad_.col(i)) / gamma_s_;
    velocities.angular_rad_s.col(i) = free_.inertia_kg_m2(i, end.turns.col(i)).inverse() * momentum;
  }
  return velocities;
}

FreeColumns FreeStep::inertia_n(const FreePoses& end) const {
  FreeColumns forces(3, 2 * free_.count());
  for (int i = 0; i < free_.count(); ++i) {
    const Eigen::Vector3d turn_rad = turned_rad(inertia_->start.turns.col(i), end.turns.col(i));
    forces.col(2 * i) = inertia_->per_s2 * free_.mass_kg(i) * (end.centers_m.col(i) - inertia_->predicted_m.col(i));
    forces.col(2 * i + 1) =
        inertia_->per_s2 * inertia_->kg_m2[static_cast<std::size_t>(i)] * (turn_rad - inertia_->predicted_rad.col(i));
  }
  return forces;
}

double free_kinetic_j(const FreeObstacles& free, const FreePoses& at, const FreeVelocities& velocities) {
  double sum_j = 0.0;
  for (int i = 0; i < free.count(); ++i) {
    const Eigen::Vector3d spin = velocities.angular_rad_s.col(i);
    sum_j += 0.5 * (free.mass_kg(i) * velocities.linear_m_s.col(i).squaredNorm() +
                    spin.dot(free.inertia_kg_m2(i, at.turns.col(i)) * spin));
  }
  return sum_j;
}

FreeColumns free_way(const FreePoses& from, const FreePoses& to) {
  FreeColumns way(3, 2 * from.centers_m.cols());
  for (Eigen::Index i = 0; i < from.centers_m.cols(); ++i) {
    way.col(2 * i) = to.centers_m.col(i) - from.centers_m.col(i);
    way.col(2 * i + 1) = turned_rad(from.turns.col(i), to.turns.col(i));
  }
  return way;
}

double free_speed_m_s(const FreeObstacles& free, const FreeVelocities& velocities) {
  double most_m_s = 0.0;
  for (int i = 0; i < free.count(); ++i)
    most_m_s = std::max(
        {most_m_s, velocities.linear_m_s.col(i).norm(), free.size_m(i) * velocities.angular_rad_s.col(i).norm()});
  return most_m_s;
}

}  // namespace soft_robot_lab
