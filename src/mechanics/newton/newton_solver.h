// SPDX-License-Identifier: BSD-3-Clause
// Newton's method on all constraints at once: positions x, element multipliers p and constraint multipliers y are
// independent unknowns (so near-incompressible elements and rigid cables cost no extra iterations). p is condensed
// element by element, y is solved as a border by its Schur complement. One factorisation an iteration.
//
//   [ A   B ] [dx]   [ -r ]     A: inertia + elements (condensed) + y d2C/dx2,  B: constraint gradients
//   [ B' -a ] [ y] = [ -o ]     a: compliance, o: offset (ConstraintLaw), y within its bounds
//
// Where constraints share their length (FrictionContact), the lengths q that slip between them are unknowns of the
// border too.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "linear_system.h"
#include "mechanics/contact/contact_response.h"
#include "mechanics/complementarity/multiplier_problem.h"
#include "mechanics/linear_algebra/anderson_mixing.h"
#include "mechanics/state/driven_constraint.h"
#include "mechanics/state/interrupt.h"
#include "mechanics/state/newton_state.h"
#include "newton_energies.h"
#include "newton_tables.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// minimise  inertia_per_s2 / 2 |x - predicted|^2_M  +  energy(x)  +  energy of the strain target
struct NewtonTask {
  double inertia_per_s2 = 0.0;                        // 1/h^2; zero asks for the equilibrium
  const Eigen::Matrix3Xd* predicted_m = nullptr;      // needed where there is inertia
  std::shared_ptr<const StrainTarget> strain_target;  // of viscosity; may be null
  double tolerance = 1e-6;
  int min_iterations = 0;
  int max_iterations = 60;
  bool only_through_stable = false;  // give up where the matrix is not convex, rather than shift it
  bool reuse_factor = false;         // first try what the last factor can still do
  double reuse_below = 0.0;          // a residual, below which the factor of the step before ends the solve
};

struct NewtonReport {
  bool converged = false;
  int iterations = 0;  // linear solves
  int factorisations = 0;
  int shortened = 0;    // steps that the line search cut
  int convexified = 0;  // iterations with a shifted matrix
  double residual = 0.0;
  int inverted_elements = 0;
  int worst_element = -1;
  double smallest_determinant = 1.0;
  double tolerance = 0.0;
  int worst_node = -1;  // with the largest residual force
  std::string reason;   // empty when converged
};

// How something moves an equilibrium, one column each: what it adds to the residual force (released, 3*node + axis; may
// be empty), to the offsets less compliance * y of active constraints, to prescribed multipliers, and to the logarithms
// of the ratios at cables' points with friction (may be empty); all at fixed unknowns.
struct NewtonDrive {
  Eigen::MatrixXd forces_n, offsets, multipliers, log_ratios;
  Eigen::MatrixXd free_forces = {};  // on free obstacles, six rows each; may be empty
};

// What follows from it, column by column.
struct NewtonResponse {
  bool stable =
      false;  // false: the tangent is not positive definite, there is no stable equilibrium; all else is empty
  Eigen::MatrixXd motions_m, multipliers, slips_m, free_motions;
  int at_limit = 0;  // points of the skin of which it depends on the direction whether they slip or stick
};

// The motions that a rest state resists least, among those that keep to the active constraints; in rising order.
struct SoftModes {
  Eigen::VectorXd stiffness_per_s2;  // over the mass; below 0 the energy falls along it. Empty: there is no factor
  Eigen::MatrixXd motions;           // 3*node + axis, one column each, of mass 1: sum of m x² = 1
};

// What acts on the nodes at a state, each as it stands in the residual: the gradient of an energy, 3 x nodes [N].
struct NewtonForces {
  Eigen::Matrix3Xd elastic_n, viscous_n, contact_n, driven_n;  // the last: of actuators' energy terms
  double elastic_j = 0.0;                                      // energy, with that of fibres
  double rubbed_j = 0.0;                  // that contact's friction takes where its anchors now follow
  std::vector<double> values;             // per constraint: C,
  std::vector<Eigen::Matrix3Xd> pulls_n;  // and y dC/dx
  FreeColumns free_n;                     // of contact on free obstacles
};

// What acts where a step ends, as work along the step, and what is stored there [J].
struct StepWork {
  double elastic_energy_j = 0.0;
  double elastic_j = 0.0, viscous_j = 0.0, contact_j = 0.0;  // of the forces as they stand in the residual
  double driven_j = 0.0;                                     // the same of actuators' energy terms
  double rubbed_j = 0.0;                                     // that contact's friction takes
  std::vector<double> values, pulls_j;                       // per constraint: C, and of y dC/dx
  Eigen::Matrix3Xd viscous_n;                                // empty where there is none
  Eigen::Matrix3Xd reactions_n;                              // of held nodes; empty unless asked for
};

// The method of one thread, with its energies and its linear system.
class NewtonSolver {
 public:
  explicit NewtonSolver(std::shared_ptr<const NewtonTables> tables);

  // What may end solve() and descend() by SolveInterrupted, and must outlive this; afterwards abandon() must follow.
  void heed(const Interrupt* interrupt);
  void abandon();

  // Improves the state in place. Where it did not converge the state is the best it had; NaN never enters it.
  NewtonReport solve(const NewtonTask& task, NewtonState& state);

  // Down the energy itself, which is finite and bounded below wherever the nodes are: for a start that is of no use to
  // solve(), such as a tangled body. The positions are the only unknowns, every step lowers the energy, and bulk and
  // rigid constraints are softened meanwhile; so the end is no solution, but a start from which solve() finds one.
  // Not for bodies whose cables have friction: friction has no energy.
  NewtonReport descend(const NewtonTask& task, NewtonState& state);

  // d x / d command at an equilibrium: columns over 3*node + axis, one per constraint, then one per driven energy
  // term; the command of each is that of its actuator. Empty when the tangent is not positive definite, so that there
  // is no stable equilibrium. `multipliers`, where given, becomes d multiplier / d command, constraints x the same
  // columns.
  Eigen::MatrixXd sensitivities(const NewtonState& state, Eigen::MatrixXd* multipliers = nullptr);

  // The derivative of an equilibrium along anything else, by the implicit function theorem with the solver's own
  // factor. Skin at the limit of friction makes it depend on the direction: each column is that of the direction in
  // which, all in all, what slipped goes on.
  NewtonResponse respond(const NewtonState& state, const NewtonDrive& drive);

  // What the residual force at an equilibrium gains where all moduli of the body grow by the factor 1 + d: the elastic
  // force, which loads and constraints balance. Over 3*node + axis.
  Eigen::VectorXd elastic_force_n(const NewtonState& state) const;

  // The gradient of the energy on held axes, zero on free ones, 3 x nodes [N]: what the holds add to the loads.
  Eigen::Matrix3Xd reaction_forces_n(const NewtonState& state) const;
  NewtonForces forces(const NewtonState& state, const std::shared_ptr<const StrainTarget>& strain_target) const;
  // `inertia_n`: with its damping, as the step had it. Where the last solve ended at this state, and no reactions are
  // asked for, it costs no pass over the body.
  StepWork work(const NewtonState& state, const std::shared_ptr<const StrainTarget>& strain_target,
                const Eigen::Matrix3Xd& inertia_n, const Eigen::Matrix3Xd& way_m, const FreeColumns& free_way,
                bool with_reactions) const;
  // By how much the potential that a task makes least is higher at one state than at another: with friction, contact,
  // and constraints that give way as carried points do. Both have the drives of `from`, and its contact but for where
  // free obstacles are.
  double potential_rise_j(const NewtonTask& task, const NewtonState& from, const NewtonState& to);

  // Of a state without motion: its residual, and whether it is a minimum of the energy. The second factorises.
  double rest_residual(const NewtonState& state) const;
  bool stable_at_rest(const NewtonState& state);
  // The same, but for what nothing resists: a motion whose stiffness is zero but for rounding is not unstable.
  bool minimum_at_rest(const NewtonState& state);
  // By subspace iteration with the factor there (Bathe 1971).
  SoftModes soft_modes(const NewtonState& state);
  // On from a rest state, as what is soft is far from it at a small residual: until the next step moves no node by more
  // than `most_m`. Full steps, each shorter than half of the one before (Deuflhard 2011, natural monotonicity), as
  // their energy is lost in rounding. Where one is not, the state stays. What is left to go; zero where there is no
  // step.
  double come_closer(const NewtonTask& task, double most_m, NewtonState& state);
  // The same without a factor, of a body that creeps to rest: by its residual and its stiffness along the motion.
  double creep_left_m(const NewtonState& state, const Eigen::Matrix3Xd& velocities_m_s) const;
  // What is left of the forces on what is not held, 3 x nodes.
  Eigen::Matrix3Xd residual_n(const NewtonState& state) const { return evaluate(NewtonTask{}, state).residual_n; }
  // How far the constraints are from their laws, relative to their values; costs no pass over the body.
  double worst_violation(const NewtonState& state) const;

  const NewtonTables& tables() const { return *tables_; }
  const NewtonEnergies& energies() const { return energies_; }
  const ContactTerm& contact() const { return energies_.contact; }
  NodalLoads& loads() { return energies_.loads; }
  LinearSystem& system() { return system_; }
  const LinearSystem& system() const { return system_; }

 private:
  struct Evaluation {
    ElementSums elements;             // volumetric_strain: beyond that at which damping would leave it free
    Eigen::Matrix3Xd residual_n;      // of the unheld degrees of freedom
    FreeColumns free_residual;        // of free obstacles
    std::vector<double> values;       // C
    std::vector<ConstraintLaw> laws;  // before anything slipped
    std::vector<FrictionContactBound> friction_contacts;
    ContactSums contact;
    double smooth_energy = 0.0;  // elastic + inertia - loads
    double relative_residual = 0.0;
    double force_scale_n = 1.0;  // of the residual
    bool finite = false;
  };
  struct Step {
    Eigen::Matrix3Xd motion_m;
    Eigen::VectorXd element_multipliers_pa, constraint_multipliers, slips_m;
    Eigen::VectorXd contact_pressures_pa, rigid_forces_n;
    FreeColumns free_motion;
    ContactSums contact_start;        // where the step starts, with the skin that it would lead into
    Eigen::VectorXd penalties;        // per constraint, for the merit function
    std::vector<ConstraintLaw> laws;  // as linearised where the step starts, with offsets at C = 0, after the slips
    double slope = 0.0;               // of the merit function along the step
    std::vector<ContactTouch> skin;   // that is a constraint of it,
    SkinColumns skin_columns;
    Eigen::VectorXd skin_changes_n;  // and of its pushes
  };

  // Of a step, before any multiplier changes.
  struct StepLoad {
    Eigen::Matrix3Xd gradient_n;
    Eigen::VectorXd load_n, motion;  // condensed, and A^-1 of it, with that of free obstacles
    FreeColumns free_n = FreeColumns(3, 0);
  };

  struct EnergyAt {
    double energy = 0.0;
    Eigen::Matrix3Xd gradient_n;
    ElementSums elements;
    std::vector<double> values;  // C
    ContactState contact;
    std::vector<ContactTouch> touches;
  };

  Evaluation evaluate(const NewtonTask& task, const NewtonState& state) const;
  double add_constraints(const NewtonState& state, Evaluation& result) const;  // how far the worst is from its law
  void let_faces_go();                                                         // that points have kept while it solved
  double add_free_obstacles(const NewtonState& state, Evaluation& result) const;  // returns free_imbalance()
  using Slip = LinearSystem::Slip;
  // How solve() finds its next step.
  struct StepPolicy {
    Slip cautious, slip;
    bool frozen_factor;
    bool convex = false;
    int secants = 0;

    bool plain() const { return !convex && slip == Slip::tangent; }
    void follow(bool accepted, bool stuck, bool shortened);  // a step
  };
  bool find_fresh_step(const NewtonTask& task, const StepPolicy& policy, const NewtonState& state,
                       const Evaluation& here, Step& step, NewtonReport& report);
  // Why there is none, or nothing.
  std::string take_fresh_step(const NewtonTask& task, StepPolicy& policy, NewtonState& state, Evaluation& here,
                              NewtonReport& report);
  MultiplierProblem problem_at(const NewtonState& state, const Eigen::MatrixXd& border_solved) const;
  NewtonResponse respond_held(const NewtonState& state, const NewtonDrive& drive) const;  // by that matrix
  NewtonDrive with_slips(const NewtonDrive& drive, const TouchesAtLimit& at_limit) const;
  bool stable_under(const MultiplierProblem& problem, const Eigen::VectorXd& multipliers) const;
  ConstraintLaw law_at(const NewtonState& state, int constraint) const;
  std::vector<FrictionContactBound> junctions_at(const Eigen::Matrix3Xd& positions_m) const;
  FreeColumns free_load(const Evaluation& here) const;  // condensed
  ContactState after(const NewtonState& state, const Step& step, double length) const;
  double first_length(const Step& step) const;
  Eigen::VectorXd condensed_residual(const Evaluation& here, const Eigen::Matrix3Xd& residual_n) const;
  void subtract_beyond(Eigen::VectorXd& load, FreeColumns& free_load) const;
  // With all skin that it would lead into among its constraints, looked for so many times; and with that which is
  // given.
  bool find_step(const NewtonState& state, const Evaluation& here, Step& step, int rounds = kRoundsAhead);
  bool find_step(const NewtonState& state, const Evaluation& here, const StepLoad& load,
                 const std::vector<ContactTouch>& ahead, Step& step);
  StepLoad step_load(const NewtonState& state, const Evaluation& here);
  bool find_multipliers(const NewtonState& state, const Evaluation& here, const Eigen::VectorXd& motion,
                        Step& step) const;
  NewtonState full_step(const NewtonState& state, const Step& step) const;
  NewtonState mix(const NewtonState& state, const Evaluation& here, const Step& step, AndersonMixing& mixing) const;
  bool try_frozen_factor(const NewtonTask& task, NewtonState& state, Evaluation& here, AndersonMixing& mixing);
  // Completes the step by what the merit function needs. `gradient_n`: of the nodes, before the step.
  void prepare_merit(const NewtonState& state, const Evaluation& here, const Eigen::Matrix3Xd& gradient_n,
                     Step& step) const;
  bool search_line(const NewtonTask& task, const Step& step, NewtonState& state, Evaluation& here,
                   double& length) const;
  // `contact`: when the step began.
  EnergyAt energy_at(const NewtonTask& task, const Eigen::Matrix3Xd& positions_m, const SharedDrives& drives,
                     const ContactState& contact) const;
  bool linearise_downhill(const NewtonTask& task, const NewtonState& state, const Eigen::VectorXd& volumetric_strain,
                          double& convexity, NewtonReport& report);
  Eigen::VectorXd downhill(const Eigen::Matrix3Xd& gradient_n, const Eigen::VectorXd& compliances,
                           const std::vector<int>& open) const;
  double merit(const Evaluation& at, const Step& step) const;

  int constraint_count() const { return tables_->constraint_count(); }
  int friction_contact_count() const { return tables_->friction_contact_count(); }

  std::shared_ptr<const NewtonTables> tables_;
  const Body& body_;  // these are the tables'
  const std::vector<DrivenConstraint>& constraints_;
  const std::vector<SharedLength>& shared_;
  const Interrupt* interrupt_ = nullptr;
  NewtonEnergies energies_;
  LinearSystem system_;

  // Where the last solve ended.
  struct End {
    Eigen::Matrix3Xd positions_m;
    Eigen::VectorXd element_multipliers_pa;
    Evaluation at;
  };
  End end_;
};

}  // namespace soft_robot_lab
