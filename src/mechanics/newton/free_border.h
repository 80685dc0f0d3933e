// SPDX-License-Identifier: BSD-3-Clause
// Free obstacles in Newton's method: six unknowns q each, as a border of the nodes' matrix A.
//
//   [ A   B ] [dx]   [ r ]     B: contact's couplings, D: contact, inertia
//   [ B'  D ] [dq] = [ f ]     dq = (D - B' A^-1 B)^-1 (f - B' A^-1 r)
//
// In an equilibrium nothing may hold an obstacle along some direction. There the Schur complement is given so much
// stiffness that its weight moves it by half its size.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "mechanics/body/free_obstacles.h"
#include "mechanics/state/free_stepping.h"

namespace soft_robot_lab {

// Energy of inertia and gravity; adds its gradient.
double add_free_gradient(const FreeObstacles& free, const FreePoses& at, const FreeInertia* inertia,
                         FreeColumns& gradient);

void add_free_inertia(const FreeObstacles& free, const FreeInertia& inertia, Eigen::MatrixXd& own);

// A force per column, and torques over the obstacle's size.
double free_norm_n(const FreeObstacles& free, const FreeColumns& forces);
// What is left of the forces on a free obstacle, over those of contact and weight on it: the largest of all, at most 1.
// A light one's are lost in the residual of the whole.
double free_imbalance(const FreeObstacles& free, const FreeColumns& contact_n, const FreeColumns& residual_n,
                      const FreeInertia* inertia);

class FreeBorder {
 public:
  FreeBorder() = default;  // of no obstacles, or of such that stay in place

  // `solved`: A^-1 B. `inertia`: of a step, which `own` holds too; null at rest.
  FreeBorder(Eigen::MatrixXd border, Eigen::MatrixXd solved, Eigen::MatrixXd own, const FreeObstacles& free,
             double youngs_modulus_pa, const FreeInertia* inertia);

  bool empty() const { return solved_.size() == 0; }
  bool stable() const { return stable_; }  // but for directions along which nothing happens

  // dq under loads f and r; the second a column each, of six rows per obstacle.
  FreeColumns motion(const FreeColumns& free_load, const Eigen::VectorXd& nodal_load) const;
  Eigen::MatrixXd motions(const Eigen::MatrixXd& free_loads, const Eigen::MatrixXd& nodal_loads) const;
  // From A^-1 r to dx where f = 0; what f adds to dx.
  void complete(const Eigen::MatrixXd& nodal_loads, Eigen::MatrixXd& of_nodes) const;
  Eigen::MatrixXd nodal_motions(const Eigen::MatrixXd& free_loads) const;
  // B dq.
  Eigen::MatrixXd nodal_forces(const Eigen::MatrixXd& free_motions) const { return border_ * free_motions; }

 private:
  Eigen::MatrixXd border_, solved_, inverse_;
  bool stable_ = true;
};

}  // namespace soft_robot_lab
