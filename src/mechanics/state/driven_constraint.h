// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/constraint.h"

namespace soft_robot_lab {

// What the actuators do while something is solved; shared with what is solved.
using SharedDrives = std::shared_ptr<const DriveStates>;

// A constraint, and its actuator's place among all.
struct DrivenConstraint {
  const Constraint* constraint;
  int actuator;

  const DriveState& drive(const SharedDrives& drives) const { return (*drives)[static_cast<std::size_t>(actuator)]; }
  double value(const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives) const {
    return constraint->value(positions_m, drive(drives));
  }
  void add_gradient(const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives, double scale,
                    Eigen::Matrix3Xd& gradient) const {
    constraint->add_gradient(positions_m, drive(drives), scale, gradient);
  }
  void add_hessian(const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives, double scale,
                   CliqueSink& hessian) const {
    constraint->add_hessian(positions_m, drive(drives), scale, hessian);
  }
  ConstraintLaw law(double value, double multiplier, const SharedDrives& drives) const {
    return constraint->law(value, multiplier, drive(drives));
  }
};

// The same of a further energy.
struct DrivenTerm {
  const EnergyTerm* term;
  int actuator;

  const DriveState& drive(const SharedDrives& drives) const { return (*drives)[static_cast<std::size_t>(actuator)]; }
};

// A contact, and its constraints among all.
struct SharedLength {
  const FrictionContact* contact;
  int first, second;
};

}  // namespace soft_robot_lab
