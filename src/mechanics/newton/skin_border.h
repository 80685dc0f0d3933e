// SPDX-License-Identifier: BSD-3-Clause
// Skin that touches skin as constraints of Newton's steps, beside those of the actuators: what touches is then found
// with the step, and a change of it needs no new factor.
//
//   [ A    B ] [dx]   [ -r ]     B: gradients of C = -g, one a point;  l >= 0: its push;  a: compliance
//   [ B'  -a ] [ l] = [  g ]
//
// A^-1 B lasts as long as the factor, or until the skin has moved along or turned.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "mechanics/contact/skin_motion.h"
#include "mechanics/state/newton_state.h"
#include "mechanics/complementarity/multiplier_problem.h"

namespace soft_robot_lab {

constexpr int kMostInBorder = 48;  // points of skin on skin; where more touch they are in the matrix
constexpr int kMostAhead = 96;     // the same, with those that a step would lead into
constexpr int kRoundsAhead = 4;    // of a step, in which it learns what these are
// Of Young's modulus: how skin that is pressed so hard turns its pressure is in the matrix.
constexpr double kHardPressed = 0.02;

struct SkinColumn {
  SkinGradient gradient;   // zero along held axes, turned back to where the factor was made
  Eigen::VectorXd solved;  // A^-1 of it
};

// Of the same point on the same face, and nearly the same: null where there is none.
std::shared_ptr<const SkinColumn> find_column(const SkinColumns& columns, const SkinGradient& gradient);

// In place of one of the same point.
void keep_column(std::shared_ptr<const SkinColumn> column, SkinColumns& columns);

// More constraints after those of a problem. `motion`: A^-1 of the load; `own_solved`: A^-1 B of those it has;
// `multipliers`: of all, where the step begins.
void add_skin(const SkinColumns& columns, const std::vector<ConstraintLaw>& laws, const Eigen::MatrixXd& own_solved,
              const Eigen::VectorXd& motion, const Eigen::VectorXd& multipliers, MultiplierProblem& problem);

}  // namespace soft_robot_lab
