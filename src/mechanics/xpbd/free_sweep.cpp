// SPDX-License-Identifier: BSD-3-Clause
#include "free_sweep.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace soft_robot_lab {

void FreeSweep::begin(double h, const FreePoses& poses, const FreeVelocities& velocities) {
  if (free_.count() == 0) return;
  SimulationState before;
  before.contact.free = poses;
  before.free_velocities = velocities;
  h_ = h;
  step_.emplace(free_, before, BackwardDifference(before, h, StepRule::implicit_euler));
  poses_ = step_->predicted();
  way_ = FreeColumns::Zero(3, 2 * free_.count());
  inverse_inertias_.clear();
  for (int i = 0; i < free_.count(); ++i) {
    inverse_inertias_.push_back(step_->inertia()->kg_m2[static_cast<std::size_t>(i)].inverse());
    way_.col(2 * i) = h * h * free_.gravity_m_s2();
  }
}

void FreeSweep::push(int free, const Eigen::Vector3d& arm_m, const Eigen::Vector3d& force_n) {
  way_.col(2 * free) += h_ * h_ / free_.mass_kg(free) * force_n;
  way_.col(2 * free + 1) += h_ * h_ * inverse_inertias_[static_cast<std::size_t>(free)] * arm_m.cross(force_n);
}

Eigen::Matrix3d FreeSweep::inverse_mass_per_kg(int free, const Eigen::Vector3d& arm_m) const {
  Eigen::Matrix3d across;
  across << 0, -arm_m.z(), arm_m.y(), arm_m.z(), 0, -arm_m.x(), -arm_m.y(), arm_m.x(), 0;
  return Eigen::Matrix3d::Identity() / free_.mass_kg(free) -
         across * inverse_inertias_[static_cast<std::size_t>(free)] * across;
}

Eigen::Vector3d FreeSweep::way_m(int free, const Eigen::Vector3d& arm_m) const {
  return way_.col(2 * free) + Eigen::Vector3d(way_.col(2 * free + 1)).cross(arm_m);
}

FreePoses FreeSweep::place() {
  if (free_.count() == 0) return {};
  poses_ = moved(poses_, way_);
  way_.setZero();
  return poses_;
}

FreeVelocities FreeSweep::velocities(const FreePoses& end) const { return step_->velocities(end); }

}  // namespace soft_robot_lab
