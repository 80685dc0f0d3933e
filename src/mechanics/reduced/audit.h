// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include <Eigen/Core>

#include "reduced_simulation.h"

namespace soft_robot_lab {

class NewtonSolver;

// How far a reduced state is from where the full model would be, judged by full Newton iterations from there, one where
// that leaves hardly any residual, and no more than six, or fifteen where skin may touch: as they converge
// quadratically (Deuflhard 2004, 2.1), they lead all of the way where it is short. An estimate and no bound: a saddle
// passes as well as a minimum. What is done where it is too large: robot/scene/scene_motion.h.
struct AuditResult {
  bool found = false;       // a solution near; otherwise the estimate means nothing
  double estimate_m = 0.0;  // rms over the markers of their way there
  int iterations = 0;
  Eigen::Matrix3Xd markers_m;  // there: the correction, 3 x markers
  // All unknowns there, as SimulationState has them.
  Eigen::Matrix3Xd positions_m;
  Eigen::VectorXd element_multipliers_pa, constraint_multipliers;
};

// A workspace of the full model, for one thread.
class Audit {
 public:
  // `full`: what the reduced model stands for, on the same mesh; with other loads or obstacles than it was trained for
  // its audits say how much these matter.
  Audit(const ReducedModel& reduced, std::shared_ptr<const Model> full);
  ~Audit();

  // Of an equilibrium.
  AuditResult at_rest(const ReducedState& state);

  // Of the end of a time step. What a step leaves out adds up over the motion: the residual with its inertia is held
  // against the stiffness alone, as modes that are left out are faster than those that move.
  AuditResult in_motion(const ReducedState& state);

 private:
  ContactState contact_at(const Eigen::Matrix3Xd& positions_m, const ReducedState& state) const;
  AuditResult iterate(const ReducedState& state, const Eigen::VectorXd* acceleration);

  const ReducedModel& reduced_;
  std::shared_ptr<const Model> full_;
  std::unique_ptr<NewtonSolver> newton_;
};

}  // namespace soft_robot_lab
