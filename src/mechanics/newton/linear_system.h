// SPDX-License-Identifier: BSD-3-Clause
// What Newton's method solves with: the matrix of all energies where they were last linearised, its factor, and the
// borders of constraints and free obstacles. One thread's.
//
//   [ A   B   F ]     A: nodes and carried points;  B: constraint gradients;  F: free obstacles (free_border.h)
//   [ B'  .   . ]     S = B' A^-1 B: Schur complement of the constraints
//   [ F'  .   D ]
//
// It can be left in place for further steps (a frozen factor), given up, and restored with a saved state.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include "contact_matrix.h"
#include "free_border.h"
#include "kept_factor.h"
#include "mechanics/linear_algebra/block_cholesky.h"
#include "mechanics/linear_algebra/block_matrix.h"
#include "mechanics/state/interrupt.h"
#include "mechanics/state/newton_state.h"
#include "newton_energies.h"
#include "newton_tables.h"
#include "skin_border.h"

namespace soft_robot_lab {

class LinearSystem {
 public:
  // Both outlive this.
  LinearSystem(const NewtonTables& tables, NewtonEnergies& energies);
  LinearSystem(const LinearSystem&) = delete;
  LinearSystem& operator=(const LinearSystem&) = delete;

  void heed(const Interrupt* interrupt) { interrupt_ = interrupt; }

  // The stiffness of friction: of what slips its tangent or its secant, or what is at the limit sticks, or all that
  // rubs on obstacles goes back to where it stuck. No further step is taken by a factor but with the tangent.
  enum class Slip { tangent, secant, held, stuck };

  // Matrix, factor and borders of this state; false where there is no factor. `convex`: each element's Hessian is made
  // positive.
  bool linearise(const NewtonState& state, double inertia_per_s2,
                 const std::shared_ptr<const StrainTarget>& strain_target, bool convex, Slip slip = Slip::tangent);
  bool linearise_held(const NewtonState& state);  // at rest, where all that is at the limit of friction sticks
  // Blends the true matrix with one that is nearly always positive, which gives its elements the multiplier that
  // cancels most of their geometric stiffness. Beyond a convexity of 1: the positive one of linearise().
  bool linearise_blend(const NewtonState& state, double inertia_per_s2,
                       const std::shared_ptr<const StrainTarget>& strain_target,
                       const Eigen::VectorXd& volumetric_strain, double convexity);
  // What the matrix of a descent is made of; skin on skin is in it.
  void take_touches(std::vector<ContactTouch> touches);
  // Whether it is linearised there; its factor is made again where it was restored alone.
  bool has_factor_at(const NewtonState& state, double inertia_per_s2,
                     const std::shared_ptr<const StrainTarget>& strain_target);
  // Whether the last factor may serve a step there, with the nodes' turns since then; it is made where it is needed.
  bool may_serve(double inertia_per_s2, bool viscous, const ContactSums& contact);
  void turn_to(const Eigen::Matrix3Xd& positions_m, const std::vector<ContactTouch>& touches);
  void forget_factor();

  // The last linearisation, or nullptr where it cannot be reused; and taking up another one. Its factor is made again
  // where something asks for it, which an equilibrium elsewhere does not.
  const std::shared_ptr<const Linearisation>& linearisation() const { return linearisation_; }
  void restore(const std::shared_ptr<const Linearisation>& linearisation);

  int negative_pivots() const { return factor().negative_pivots(); }
  struct Border {
    Eigen::MatrixXd columns, solved, delassus;  // B and A^-1 B, over 3*node + axis; S
  };
  const Border& border() const { return border_; }
  const FreeBorder& free_border() const { return free_border_; }
  const Turns& turns() const { return turns_; }
  const std::vector<ContactTouch>& touches() const { return touching_.points; }  // of which the matrix was made
  const RigidTouches& rigid_touches() const { return touching_.rigid; }
  void find_edges(const Eigen::Matrix3Xd& positions_m);  // that touches have met, SkinContact::find_edges
  // Skin on skin is not in the matrix, but a constraint of each step.
  bool skin_in_border() const { return skin_in_border_; }

  Eigen::MatrixXd solve(const Eigen::MatrixXd& right_hand_sides) const;  // of the nodes
  // The same where carried points are just where their nodes carry them; the ties of the matrix let them give way.
  // And with free obstacles: a column each, their rows as FreeBorder has them.
  struct ExactMotions {
    Eigen::MatrixXd motions_m, free;
  };
  ExactMotions solve_exactly(const Eigen::MatrixXd& loads_n, const Eigen::MatrixXd& free_loads = {}) const;

  // Of skin that touches, in the border. One pass of the factor solves for loads and for all columns that are missing.
  Eigen::MatrixXd solve_with(Eigen::MatrixXd loads, const std::vector<ContactTouch>& touches);
  SkinColumns columns_of(const std::vector<ContactTouch>& touches);

 private:
  bool slides_where_met(const ContactTouch& touch) const;
  bool add_rest_and_factorise(const NewtonState& state, double inertia_per_s2, bool convex);  // all but elements
  bool factorise(bool convex);                                                                // with skin on skin
  void border_free_obstacles(const NewtonState& state, bool convex);
  // Whether skin on skin may be a constraint of each step, where no more points of it than that touch.
  bool may_be_in_border(const std::vector<ContactTouch>& touches, int most) const;
  bool any_in_matrix(const std::vector<ContactTouch>& touches) const;
  void include_in_pattern(std::vector<FacePair> closed);
  const BlockCholesky& factor() const { return skin_matrix_.used ? skin_matrix_.whole->factor : factor_; }
  const BlockMatrix& whole_matrix() const { return skin_matrix_.used ? skin_matrix_.whole->matrix : matrix_; }
  bool linearised_at(const NewtonState& state, double inertia_per_s2,
                     const std::shared_ptr<const StrainTarget>& strain_target) const;
  bool make_factor();  // of linearisation_, where factor_ holds that of another
  void exchange(KeptFactor& other);
  bool may_be_kept() const;
  void keep_factor();  // before another one is made
  bool take_up_kept_factor();
  // What the motions add to the residuals, but for the coupling of free obstacles that the matrix has.
  ExactMotions exact_forces_n(const ExactMotions& motions) const;
  SkinGradient released_gradient(const ContactTouch& touch) const;
  std::vector<SkinGradient> without_column(const std::vector<ContactTouch>& touches) const;
  Eigen::MatrixXd solve_and_keep(Eigen::MatrixXd loads, std::vector<SkinGradient> missing);
  void keep_skin_columns();

  const NewtonTables& tables_;
  NewtonEnergies& energies_;
  const Interrupt* interrupt_ = nullptr;

  BlockMatrix matrix_;
  BlockCholesky factor_;
  struct SkinMatrix {  // in place of both, where skin touches skin
    std::unique_ptr<ContactMatrix> whole;
    std::shared_ptr<const ContactPattern> pattern;  // the last one
    bool used = false;
  };
  SkinMatrix skin_matrix_;
  std::vector<KeptFactor> kept_;  // the oldest first
  bool skin_in_border_ = false;

  // The last linearisation, and that whose factor is in factor_ and whose volume gradients the elements have: another
  // one after restore(). Null where it was convex or failed.
  std::shared_ptr<const Linearisation> linearisation_, factorised_;
  Border border_;
  struct Touching {
    std::vector<ContactTouch> points;
    RigidTouches rigid;
  };
  Touching touching_;
  FreeBorder free_border_;
  Turns turns_;               // of the nodes since then, by which the old factor turns with them
  SkinColumns skin_columns_;  // of that factor
};

}  // namespace soft_robot_lab
