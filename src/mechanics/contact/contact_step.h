// SPDX-License-Identifier: BSD-3-Clause
// Contact in a step of Newton's method: its condensation, where it leads, and its merit.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "contact_term.h"
#include "soft_robot_lab/mechanics/constraint.h"

namespace soft_robot_lab {

// Whether the matrix of these touches may serve others: the same are closed, on the same faces. What sticks and what
// slips may differ.
bool same_set(const std::vector<ContactTouch>& a, const std::vector<ContactTouch>& b, bool with_skin);

// What condensation adds to the residual; `linearised`: the touches the matrix was made of. `with_skin`: those of skin
// on skin are in it; else they are constraints of the step.
void add_mismatch_forces(const ContactTerm& contact, const std::vector<ContactTouch>& linearised,
                         const ContactSums& here, bool with_skin, Eigen::Matrix3Xd& forces_n);
FreeColumns free_mismatch_forces_n(const ContactTerm& contact, const std::vector<ContactTouch>& linearised,
                                   const ContactSums& here);
Eigen::VectorXd next_pressures_pa(const ContactTerm& contact, const std::vector<ContactTouch>& linearised,
                                  const ContactSums& here, bool with_skin, const Eigen::Matrix3Xd& motion_m,
                                  const FreeColumns& free_motion);

// Of a touch as a constraint of the step (SkinGradient), and its push [N].
ConstraintLaw law_of(const ContactTerm& contact, const ContactTouch& touch);
inline double push_n(const ContactTerm& contact, const ContactTouch& touch) {
  return contact.weight_m2(touch.pair) * touch.pressure_pa;
}

// What a motion of the nodes would lead into: skin that touches at its end and is not among `known`; with the gap that
// this leaves where the motion begins.
std::vector<ContactTouch> met_by(const ContactTerm& contact, const Eigen::Matrix3Xd& motion_m, const ContactSums& end,
                                 const std::vector<ContactTouch>& known);

// Of touches that are `held`: what the residual lacks for that.
void add_beyond(const ContactTerm& contact, const std::vector<ContactTouch>& touches, Eigen::Matrix3Xd& residual_n,
                FreeColumns& free);

// NormalLaw::mismatch_m over the size of the face, of these pairs; zero where one does not touch.
Eigen::VectorXd mismatches(const ContactTerm& contact, const ContactSums& at, const std::vector<Eigen::Index>& pairs);

// Augmented Lagrangian of the normal law at the pressures where a step leads, and friction's potential as it was where
// the step starts. `slope_change`: what the slope of all along the step lacks where it is taken from the residual.
double merit_j(const ContactTerm& contact, const ContactSums& at, const ContactSums& start,
               const Eigen::VectorXd& next_pressures_pa);
double slope_change_j(const ContactTerm& contact, const ContactSums& start, const Eigen::VectorXd& next_pressures_pa,
                      const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion);

// With the soft compliance the pressures follow from the positions: sets them, and returns the energy. Friction keeps
// the limits of `limits_pa`, pressures per pair.
double soft_energy(const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m, const Eigen::VectorXd& limits_pa,
                   ContactState& state, ContactSums& at);

}  // namespace soft_robot_lab
