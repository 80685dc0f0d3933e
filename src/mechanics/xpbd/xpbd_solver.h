// SPDX-License-Identifier: BSD-3-Clause
// XPBD (Macklin, Mueller & Chentanez 2016) with substeps (Macklin et al. 2019, "Small steps"), one element after
// another. The compliant constraint of an element is vector-valued: its multipliers are the forces f on its nodes,
// which follow f = dE/dx. Splitting it into scalar constraints makes parts fight that cancel only together. Eq. 18 of
// the paper, for all coordinates of the element at once, with K = d2E/dx2 (volume multiplier condensed) and all masses
// M of its nodes:
//   (M/h^2 + K) dx = -(dE/dx - f),   f <- f - M dx/h^2
// or, symmetric and without the infinite masses of held nodes, with l = -h^2 M^-1/2 f and y = M^1/2 dx:
//   (I + h^2 M^-1/2 K M^-1/2) y = -h^2 M^-1/2 dE/dx - l,   l <- l + y
// The sum of the forces of an element stays zero, K and its convex shift being blind to translation.
//
// Departure from the paper: with one sweep a substep it starts multipliers at zero, and then the body is softer by
// terms of h^2 that come from elements which pull against each other: a silicone cantilever sagged 49 % too far with 50
// substeps at 60 Hz, 14 % with 100. Multipliers kept from the substep before (as contact solvers do) leave a body at
// rest exactly where its forces balance. The price is that too long substeps create energy, which is in the report:
// on a chain of springs k between masses m beyond h^2 k/m = 2. Neither sweeping to and fro by turns, nor two sweeps,
// nor a stiffer element, nor keeping a part of the multipliers with their mean changes that.
//
// Where a rest state is sought nothing needs to swing. With the velocities at zero in each substep this is the
// alternating direction method of multipliers (Boyd et al. 2011, doi 10.1561/2200000016), one element after another,
// with M/h^2 as its penalty. On that chain it goes to rest with substeps of any length.
//
// S = I + h^2 M^-1/2 K M^-1/2 is not inverted anew for each element in each sweep; see element_step.h.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "contact_sweep.h"
#include "element_step.h"
#include "mechanics/complementarity/multiplier_problem.h"
#include "mechanics/contact/contact_term.h"
#include "mechanics/state/interrupt.h"
#include "mechanics/state/newton_state.h"
#include "substep_hysteresis.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/constraint.h"

namespace soft_robot_lab {

struct XpbdTask {
  double time_step_s = 1.0 / 60.0;
  int substep_count = 20;
  int iteration_count = 1;             // sweeps a substep
  bool multipliers_from_zero = false;  // in each substep, as in the paper
  // What the actuators do in a substep, by the share of the step that is over at its end; empty: what they did before.
  std::function<SharedDrives(double)> drives_at;
  SubstepHysteresis* hysteresis = nullptr;  // null: there is none, or a rest state is sought
  // A rest state is sought: nothing swings, substeps are no time (substepping.cpp), there is no viscosity and no
  // contact, and what slips does so from where the search began.
  bool at_rest = false;
  const ContactTerm* contact = nullptr;  // null: nothing touches
  double until_s = 0.0;                  // of the motion of obstacles and holds, from ContactState::time_s on
  // What holds that move in this step add to the loads (NewtonSolver::reaction_forces_n); empty: none moves.
  std::function<Eigen::Matrix3Xd(const NewtonState&)> reactions_n;
};

struct XpbdState {
  NewtonState unknowns;
  Eigen::Matrix3Xd velocities_m_s;
  Eigen::VectorXd element_forces_n;       // multipliers, in an order of the solver's own; force_count() numbers
  Eigen::VectorXd branch_stress_pa = {};  // of hysteresis; as SimulationState has it
  std::shared_ptr<const KeptSolves> kept = nullptr;  // null: none are
  FreeVelocities free_velocities = {};               // of free obstacles
};

struct XpbdReport {
  bool finite = false;
  bool stable = false;          // finite, and hardly any energy came from nowhere
  double created_energy = 0.0;  // energy at the end that neither was there nor was brought by work, over what there was
  double kinetic_energy_j = 0.0;  // at the end, with free obstacles
  int substeps = 0;               // of the step that was kept
  int sweeps = 0;                 // over all elements, of all attempts
  int rejected_steps = 0;
  double first_motion = 0.0, last_motion = 0.0;  // towards rest, in the first and in the last substep
  // Of the last substep, for its residual: where it started, and where its inertia and hysteresis led.
  Eigen::Matrix3Xd started_m, predicted_m;
  std::shared_ptr<const FreeInertia> free_inertia;
};

// 3 x nodes [1/kg, 1/kg^1/2]; zero where held.
struct InverseMasses {
  Eigen::Matrix3Xd whole, root;
};

// What it works out once about a body and its constraints; solvers in several threads share it.
struct XpbdTables {
  // Body and constraints outlive this.
  XpbdTables(const Body& body, std::vector<DrivenConstraint> constraints, std::vector<SharedLength> shared = {});

  const Body& body;
  std::vector<DrivenConstraint> constraints;
  std::vector<SharedLength> shared;
  Eigen::Matrix3Xd loads_n;
  std::vector<int> colour_start;  // first batch of each colour, and the end
  ElementBatches batches;
  InverseMasses moving;
  // Where a rest state is sought any masses do. These are the nodes' stiffness by shear, sum mu w |grad N|^2, times
  // (1 s)^2, so that elements of all shapes and sizes come to their forces in as many substeps.
  InverseMasses resting;
};

// The workspace of one thread, which may take others to its help.
class XpbdSolver {
 public:
  // The result does not depend on `thread_count`.
  XpbdSolver(std::shared_ptr<const XpbdTables> tables, int thread_count);

  // As NewtonSolver has them.
  void heed(const Interrupt* interrupt) { interrupt_ = interrupt; }
  void abandon() { kept_.reset(); }

  // One time step in place. Where it is not finite the state is of no use afterwards.
  XpbdReport advance(const XpbdTask& task, XpbdState& state);

  // The same, repeated with twice the substeps, up to 16 times as many, while it creates energy. Where that does not
  // help the finest finite attempt is kept; where none is finite, not even with multipliers from zero, the state stays
  // as it was.
  XpbdReport advance_stably(XpbdTask task, XpbdState& state);

  // What a difference of the nodes' places and of the elements' forces counts on the way to rest, sqrt(M) and
  // h^2 / sqrt(M).
  Eigen::VectorXd weights_at_rest(double h) const;

  // The multipliers that follow from a shape alone, dE/dx of each element. With zeros in their place the first substep
  // lets go of a body under tension.
  Eigen::VectorXd forces_of(NewtonState state);
  void take_loads(const Eigen::Matrix3Xd& loads_n) { loads_n_ = loads_n; }
  Eigen::Index force_count() const { return static_cast<Eigen::Index>(multipliers_.size()) * kLanes; }

 private:
  ElementStep element_step(double h, NewtonState& state, const Eigen::Matrix3Xd* start_m = nullptr);
  void take_up(const std::shared_ptr<const KeptSolves>& kept, double h, double dashpot);
  void let_go(std::shared_ptr<const KeptSolves>& kept);
  void load_multipliers(const Eigen::VectorXd& forces_n, double h);
  void save_multipliers(double h, Eigen::VectorXd& forces_n) const;
  void predict(const XpbdTask& task, double h, XpbdState& state);
  // `start_m`: where the substep began.
  void sweep(const XpbdTask& task, double h, const Eigen::Matrix3Xd& start_m, NewtonState& state);
  // `start_m`: where the substep began, for viscosity; null: without any.
  void sweep_elements(double h, NewtonState& state, const Eigen::Matrix3Xd* start_m = nullptr);
  void stop(XpbdState& state, bool first, XpbdReport& report) const;
  void sweep_constraints(const XpbdTask& task, double h, NewtonState& state);
  void solve_constraints(const XpbdTask& task, double h, NewtonState& state);  // all at once, where friction joins them
  void find_gradients(const NewtonState& state);
  MultiplierProblem problem_at(double h, const NewtonState& state, bool slips_go_on);
  // What a step does to the energy.
  struct Account {
    double before_j = 0.0, work_j = 0.0, moved_j = 0.0;
    std::vector<double> values;  // of the constraints

    void bring(double by_j) {
      work_j += by_j;
      moved_j += std::abs(by_j);
    }
  };
  Account open_account(const XpbdTask& task, const XpbdState& state);
  void add_work(const XpbdTask& task, const Eigen::Matrix3Xd& motion_m, const NewtonState& state,
                Account& account) const;
  void close_account(const XpbdTask& task, const Account& account, const XpbdState& state, XpbdReport& report);
  void add_free_obstacles(const XpbdState& state, XpbdReport& report) const;
  ConstraintLaw law_at(std::size_t constraint, const NewtonState& state) const;
  double kinetic_energy(const Eigen::Matrix3Xd& velocities_m_s) const;
  double stored_energy(const Eigen::Matrix3Xd& positions_m);
  const std::vector<int>& touched_by(std::size_t constraint, const NewtonState& state);
  // A place among the multipliers: a coordinate of a node of four elements.
  std::size_t element_size() const { return static_cast<std::size_t>(tables_->batches.node_count) * 3; }
  int coordinate(std::size_t place, int lane) const {
    return 3 * tables_->batches.nodes[place / 3 * kLanes + lane] + static_cast<int>(place % 3);
  }
  double root_inverse_mass(std::size_t place, int lane) const { return masses_->root.data()[coordinate(place, lane)]; }
  template <class Work>
  void for_colours(Work work) const;

  std::shared_ptr<const XpbdTables> tables_;
  Eigen::Matrix3Xd loads_n_;  // the tables', and what pulls now
  const InverseMasses* masses_;
  const Interrupt* interrupt_ = nullptr;
  int thread_count_;
  Batches multipliers_;        // l, per batch: 3 P
  Eigen::Matrix3Xd pushed_m_;  // sum of M^-1/2 l: how far the elements push the nodes in a substep
  ElementSolves solves_;
  std::shared_ptr<const KeptSolves> kept_;  // what solves_ was, when it was last let go or taken up
  Batches energies_;                        // per batch
  Eigen::Matrix3Xd gradient_;               // of one constraint; zero between uses
  std::vector<int> touched_;                // its nodes
  std::vector<std::vector<int>> nodes_;     // per constraint, from when it was first asked; empty: not yet
  struct NodeGradient {
    std::vector<int> nodes;
    Eigen::Matrix3Xd columns;
  };
  std::vector<NodeGradient> gradients_;  // of all constraints, where friction joins them
  std::optional<ContactSweep> contact_;  // of a step
};

}  // namespace soft_robot_lab
