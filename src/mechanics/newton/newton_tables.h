// SPDX-License-Identifier: BSD-3-Clause
// What Newton's method works out once about a body and its constraints: who is coupled with whom, in which order nodes
// are eliminated, and where everything goes in the matrix. It does not change, so that solvers in several threads share
// it; each has a matrix, a factor and scratch of its own (newton_solver.h).
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include <Eigen/Core>

#include "mechanics/contact/contact_term.h"
#include "mechanics/linear_algebra/block_cholesky.h"
#include "mechanics/linear_algebra/block_matrix.h"
#include "mechanics/elements/clique_adder.h"
#include "mechanics/state/driven_constraint.h"
#include "mechanics/state/newton_state.h"
#include "mechanics/elements/elements.h"
#include "mechanics/elements/node_turns.h"
#include "energy_terms.h"
#include "matrix_layout.h"
#include "soft_robot_lab/mechanics/body.h"
#include "co_rotated_step.h"

namespace soft_robot_lab {

struct NewtonTables {
  // Body and constraints outlive this.
  NewtonTables(const Body& body, std::vector<DrivenConstraint> constraints, std::vector<SharedLength> shared = {},
               std::vector<DrivenTerm> terms = {});

  int constraint_count() const { return static_cast<int>(constraints.size()); }
  int term_count() const { return static_cast<int>(terms.driven().size()); }
  int friction_contact_count() const { return static_cast<int>(shared.size()); }
  int element_multiplier_count() const { return static_cast<int>(elements->rest_volumes_m3().size()); }
  void release(Eigen::Matrix3Xd& forces) const;  // zero on held degrees of freedom
  const CoRotatedStep& co_rotation() const;      // made when it is first asked for: many a body never needs it

  const Body& body;
  std::vector<DrivenConstraint> constraints;
  std::vector<SharedLength> shared;
  EnergyTerms terms;
  MatrixLayout layout;
  Eigen::Matrix3Xd loads_n;
  double force_floor_n;            // forces below this count as none
  std::vector<Eigen::Index> held;  // degrees of freedom, 3*node + axis
  std::shared_ptr<const BlockPattern> matrix;
  std::shared_ptr<const FactorPattern> factor;
  std::shared_ptr<const ElementTables> elements;
  NodeTurns turns;
  CliquePlaces ties;
  ContactTerm contact;
  CliquePlaces faces;                 // of contact
  std::vector<CliquePlaces> cliques;  // per constraint

 private:
  mutable std::once_flag co_rotation_made_;
  mutable std::unique_ptr<const CoRotatedStep> co_rotation_;
};

// Of all constraints, released, a column each over 3*node + axis: dC/dx.
Eigen::MatrixXd constraint_gradients(const NewtonTables& tables, const NewtonState& state);

}  // namespace soft_robot_lab
