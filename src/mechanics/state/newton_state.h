// SPDX-License-Identifier: BSD-3-Clause
// What newton and xpbd solve for, and where the matrix was made that serves further steps.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "driven_constraint.h"
#include "soft_robot_lab/mechanics/obstacle.h"

namespace soft_robot_lab {

// These belong to those who make and read them; a state only hands them on.
class ContactPattern;
struct FreeInertia;
struct SkinColumn;
struct StrainTarget;

// Of nodes, over 3*node + axis.
inline Eigen::Map<const Eigen::VectorXd> as_vector(const Eigen::Matrix3Xd& columns) {
  return {columns.data(), columns.size()};
}

using SkinColumns = std::vector<std::shared_ptr<const SkinColumn>>;

// The unknowns, and what the actuators do meanwhile.
struct NewtonState {
  Eigen::Matrix3Xd positions_m;            // 3 x nodes
  Eigen::VectorXd element_multipliers_pa;  // p
  Eigen::VectorXd constraint_multipliers;  // y
  Eigen::VectorXd slips_m = {};            // q, one per contact, since the step began
  SharedDrives drives = nullptr;           // needed where there are constraints
  ContactState contact = {};               // its pressures, forces and poses are unknowns, the rest stays
  std::shared_ptr<const FreeInertia> free_inertia = nullptr;  // of free obstacles; null at rest
};

// Where a NewtonSolver's matrix was last made. With it a saved state goes on to the last bit as if it had never
// stopped.
struct Linearisation {
  std::shared_ptr<const NewtonState> at;
  double inertia_per_s2 = 0.0;
  std::shared_ptr<const StrainTarget> strain_target;
  std::shared_ptr<const ContactPattern> contact_pattern;  // null where it has no skin on skin
  SkinColumns skin_columns;                               // that the factor was asked for since
};

}  // namespace soft_robot_lab
