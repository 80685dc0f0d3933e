// SPDX-License-Identifier: BSD-3-Clause
// The small problem that is left of a Newton step once the nodes are eliminated: multipliers y and slips q with
//   S y + D q = e      where y is within its bounds (less or more than e on them)
//   y_first <= ratio y_second and y_second <= ratio y_first      q > 0 or q < 0 only on these bounds
// S: how far each value gives way to each multiplier, compliance included. D: +1 for a contact's first constraint, -1
// for its second.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/constraint.h"

namespace soft_robot_lab {

struct FrictionContactBound {
  int first, second;
  double ratio;
};

struct MultiplierProblem {
  Eigen::MatrixXd delassus;  // S
  Eigen::VectorXd excess;    // e
  std::vector<ConstraintLaw> laws;
  std::vector<FrictionContactBound> friction_contacts;
};

struct Multipliers {
  bool found = false;
  Eigen::VectorXd y, slips_m;
};

// `guess`: multipliers of a problem nearby.
Multipliers solve_multipliers(const MultiplierProblem& problem, const Eigen::VectorXd& guess);

// Whether the law, and no bound, decides the multiplier y.
bool active(const ConstraintLaw& law, double y);

// How far a constraint is from its law at multiplier y: zero on a bound that holds it (a slack cable).
double violation(const ConstraintLaw& law, double y);
// Over the constraint's own value, so that lengths and volumes count alike.
double relative_violation(const ConstraintLaw& law, double y, double value);

// Whether a contact's multipliers are on a bound, so that length slips: 1 towards the first, -1 towards the second.
int slipping(const FrictionContactBound& contact, const Eigen::VectorXd& y);

// Per constraint the number of its group: constraints between which length slips are one, and hold no more than the sum
// of their values.
std::vector<int> slipping_groups(const MultiplierProblem& problem, const Eigen::VectorXd& y);

// The laws once lengths have slipped.
std::vector<ConstraintLaw> after_flows(std::vector<ConstraintLaw> laws,
                                       const std::vector<FrictionContactBound>& friction_contacts,
                                       const Eigen::VectorXd& slips_m);

// How far multipliers and flow of a contact are from its law, relative to the larger multiplier, which counts as
// `least_n` at least, or to `length_m`.
double friction_violation(const FrictionContactBound& contact, const Eigen::VectorXd& y, double flow_m, double least_n,
                          double length_m);

// Solves S y = b with y between bounds, S positive definite, without friction_contacts.
Eigen::VectorXd solve_bounded(const Eigen::MatrixXd& s, const Eigen::VectorXd& b,
                              const std::vector<ConstraintLaw>& laws);

// Lemke's method for the whole problem: finds a solution wherever S is positive definite, because then its linear
// complementarity matrix is copositive (Cottle, Pang & Stone 2009, 4.4).
Multipliers solve_by_lemke(const MultiplierProblem& problem);

}  // namespace soft_robot_lab
