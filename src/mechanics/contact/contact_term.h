// SPDX-License-Identifier: BSD-3-Clause
// Contact of a body's skin with rigid obstacles and with itself, as a term of Newton's method: what it adds to the
// residual, the matrix, the step, and the merit function. What changes is ContactState; of its own it only remembers
// which skin is near which, so an object serves one thread.
//
// Pressures are unknowns of their own, condensed point by point as the elements' volumes are: with g the gap, n its
// gradient, a the compliance, w the weight and N the shape functions of a closed point
//   residual  - w l n N     matrix  w / a (n n') N N' - w l (grad grad g) N N'     l+ = max(0, -(g + n.dx) / a)
// All nodes of a face are in one element, so the pattern of the matrix stays. Where skin meets skin (SkinContact) both
// faces are in the matrix, so its pattern grows (ContactMatrix).
//
// A free obstacle is pushed back by what touches it. Its motion stands beside that of the nodes, in FreeColumns, and
// the couplings of the two are columns of a border (FreeBorder).
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "mechanics/body/contact_points.h"
#include "contact_touch.h"
#include "mechanics/body/free_obstacles.h"
#include "normal_law.h"
#include "rigid_contact.h"
#include "skin_contact.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/constraint.h"
#include "soft_robot_lab/mechanics/obstacle.h"

namespace soft_robot_lab {

// Contact at some positions and pressures.
struct ContactSums {
  std::vector<ContactTouch> touches;  // all with pressure or penetration, and the closed ones; by pairs, ascending
  Eigen::Matrix3Xd points_m;          // where all contact points of obstacles are
  Eigen::Matrix3Xd positions_m;       // of the nodes, where skin rubs on skin; else empty
  double mismatch = 0.0;              // the largest, over the size of its face
  FreePoses free;
  RigidTouches rigid;
};

// What stands at the limit of friction: points of the skin, and after these obstacles among themselves.
struct TouchesAtLimit {
  std::vector<ContactTouch> points;
  RigidTouches rigid;

  Eigen::Index count() const { return static_cast<Eigen::Index>(points.size() + rigid.size()); }
};

class ContactTerm {
 public:
  explicit ContactTerm(const Body& body);

  bool empty() const { return obstacles_.empty() && skin_.pair_count() == 0; }
  double end_of_motion_s() const;                          // of all obstacles
  bool moves_between(double from_s, double to_s) const;    // whether any does
  std::vector<Clique> cliques() const;                     // for add_hessian: the faces
  const ContactPoints& points() const { return points_; }  // of obstacles
  const SkinContact& skin() const { return skin_; }
  void keep_faces(const std::vector<ContactTouch>& touches) { skin_.keep_faces(touches); }
  void let_faces_go() { skin_.let_faces_go(); }
  double face_size_m(const ContactTouch& touch) const {
    return points_of(touch.pair).face_size_m(point_of(touch.pair));
  }
  const FreeObstacles& free() const { return free_; }
  const RigidContact& rigid() const { return rigid_; }
  Eigen::Isometry3d pose_of(int obstacle, const ContactState& state) const;  // from its shape as stated

  // Of a body at these positions that did not touch anything before.
  ContactState untouched(const Eigen::Matrix3Xd& positions_m, double time_s) const;

  ContactSums sums(const Eigen::Matrix3Xd& positions_m, const ContactState& state) const;
  void add_forces(const ContactSums& at, Eigen::Matrix3Xd& residual_n) const;
  FreeColumns free_forces_n(const ContactSums& at) const;  // the same on free obstacles

  // Of obstacles; of skin SkinContact has it. `convex` leaves out what may make the matrix indefinite; `soft` is for
  // soft_energy.
  void add_hessian(const std::vector<ContactTouch>& touches, bool convex, bool soft, CliqueSink& matrix) const;
  // Of free obstacles: with the nodes, 3*node + axis x columns, and among themselves.
  void add_free_hessian(const std::vector<ContactTouch>& touches, bool convex, Eigen::MatrixXd& border,
                        Eigen::MatrixXd& own) const;

  // Whether the matrix of these touches may serve others: the same are closed, on the same faces. What sticks and what
  // slips may differ.
  static bool same_set(const std::vector<ContactTouch>& a, const std::vector<ContactTouch>& b, bool with_skin);

  // What condensation adds to the residual; `linearised`: the touches the matrix was made of. `with_skin`: those of
  // skin on skin are in it; else they are constraints of the step.
  void add_mismatch_forces(const std::vector<ContactTouch>& linearised, const ContactSums& here, bool with_skin,
                           Eigen::Matrix3Xd& forces_n) const;
  FreeColumns free_mismatch_forces_n(const std::vector<ContactTouch>& linearised, const ContactSums& here) const;
  Eigen::VectorXd next_pressures_pa(const std::vector<ContactTouch>& linearised, const ContactSums& here,
                                    bool with_skin, const Eigen::Matrix3Xd& motion_m,
                                    const FreeColumns& free_motion) const;

  // Of a touch as a constraint of the step (SkinGradient), and its push [N].
  ConstraintLaw law_of(const ContactTouch& touch) const;
  double push_n(const ContactTouch& touch) const { return weight_m2(touch.pair) * touch.pressure_pa; }
  double pressure_pa(const ContactTouch& touch, double push_n) const { return push_n / weight_m2(touch.pair); }
  double weight_m2(int pair) const { return points_of(pair).weight_m2(point_of(pair)); }
  double friction_of(const ContactTouch& touch) const {  // Coulomb's coefficient
    return touch.on_skin() ? skin_.friction(touch) : obstacle_of(touch.pair).friction;
  }
  // The nodes of the face, and of skin that it meets, with their shares of how the point moves against that; their
  // number.
  int nodes_of(const ContactTouch& touch, std::array<int, 12>& nodes, std::array<double, 12>& shares) const;
  // What a motion of the nodes would lead into: skin that touches at its end and is not among `known`; with the gap
  // that this leaves where the motion begins.
  std::vector<ContactTouch> met_by(const Eigen::Matrix3Xd& motion_m, const ContactSums& end,
                                   const std::vector<ContactTouch>& known) const;
  // Of touches at the limit of friction. What the residual gains where one of them slips by a metre; and by how much a
  // motion takes the tie of each beyond its limit, which follows the pressure, as a way of slip.
  void add_slip(const TouchesAtLimit& all, Eigen::Index one, Eigen::Matrix3Xd& residual_n, FreeColumns& free_n) const;
  Eigen::VectorXd beyond_limits_m(const TouchesAtLimit& all, const Eigen::Matrix3Xd& motion_m,
                                  const FreeColumns& free_motion) const;
  Eigen::VectorXd limits_n(const TouchesAtLimit& all) const;
  // Ties turn with a surface that is not flat, or that moves, and obstacles roll: what the matrix, which is symmetric,
  // lacks.
  bool any_turns(const std::vector<ContactTouch>& touches, const RigidTouches& rigid) const;
  void add_turned_ties(const std::vector<ContactTouch>& touches, const RigidTouches& rigid,
                       const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion, Eigen::Matrix3Xd& residual_n,
                       FreeColumns& free_n) const;

  // Of touches that are `held`: what the residual lacks for that.
  void add_beyond(const std::vector<ContactTouch>& touches, Eigen::Matrix3Xd& residual_n, FreeColumns& free) const;

  // NormalLaw::mismatch_m over the size of the face, of these pairs; zero where one does not touch.
  Eigen::VectorXd mismatches(const ContactSums& at, const std::vector<Eigen::Index>& pairs) const;

  // Augmented Lagrangian of the normal law at the pressures where a step leads, and friction's potential as it was
  // where the step starts. `slope_change`: what the slope of all along the step lacks where it is taken from the
  // residual.
  double merit_j(const ContactSums& at, const ContactSums& start, const Eigen::VectorXd& next_pressures_pa) const;
  double slope_change_j(const ContactSums& start, const Eigen::VectorXd& next_pressures_pa,
                        const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion) const;

  // With the soft compliance the pressures follow from the positions: sets them, and returns the energy. Friction keeps
  // the limits of `limits_pa`, pressures per pair.
  double soft_energy(const Eigen::Matrix3Xd& positions_m, const Eigen::VectorXd& limits_pa, ContactState& state,
                     ContactSums& at) const;

  // Lets anchors follow what slipped, and what does not touch.
  void commit(const Eigen::Matrix3Xd& positions_m, ContactState& state) const;

  // What friction dissipates where the anchors follow what slipped, by commit().
  double rubbed_j(const ContactSums& at) const;

  std::vector<ContactReading> readings(const Eigen::Matrix3Xd& positions_m, const ContactState& state) const;

 private:
  ContactReading& reading_of(const ContactTouch& touch, std::vector<ContactReading>& all) const;
  int obstacle_pairs() const { return static_cast<int>(obstacles_.size()) * points_.count(); }
  Eigen::Index pair_count() const { return obstacle_pairs() + skin_.points().count(); }
  NormalLaw law(const ContactTouch& touch) const;
  NormalLaw law_on_obstacle(int point) const;
  bool of_skin(int pair) const { return pair >= obstacle_pairs(); }
  const ContactPoints& points_of(int pair) const { return of_skin(pair) ? skin_.points() : points_; }
  int point_of(int pair) const { return of_skin(pair) ? pair - obstacle_pairs() : pair % points_.count(); }
  int face_of(int pair) const { return points_of(pair).face_of(point_of(pair)); }
  double slack_m(int pair) const { return of_skin(pair) ? skin_.slack_m(point_of(pair)) : 0.0; }
  const Obstacle& obstacle_of(int pair) const { return obstacles_[static_cast<std::size_t>(pair / points_.count())]; }
  Eigen::Matrix3Xd all_points(const Eigen::Matrix3Xd& positions_m) const;
  void find_touches(int obstacle, const Eigen::Matrix3Xd& positions_m, const ContactState& state,
                    ContactSums& sums) const;
  // Along the surface, from its anchor to where a touch of `start` now is.
  Eigen::Vector3d away_m(const ContactTouch& touch, const ContactSums& start, const ContactSums& now) const;
  void add_friction(const Eigen::Isometry3d& pose, int obstacle, const ContactState& state, const ContactSums& sums,
                    ContactTouch& touch) const;
  // What condensation pushes with, where the matrix was made of these.
  std::vector<Eigen::Vector3d> mismatch_forces_n(const std::vector<ContactTouch>& linearised,
                                                 const ContactSums& here) const;
  Eigen::Vector3d force_n(const ContactTouch& touch) const;  // as in the residual
  // On the point, and back on the skin that it meets.
  void add_at(const ContactTouch& touch, const Eigen::Vector3d& force_n, Eigen::Matrix3Xd& forces_n) const;
  // How a point moves against what it touches.
  Eigen::Vector3d relative_motion_m(const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                                    const FreeColumns& free_motion) const;
  // Of ContactTouch::away_m, by that and the rest.
  Eigen::Vector3d away_motion_m(const ContactTouch& touch, const Eigen::Vector3d& relative_m,
                                const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion) const;
  double beyond_limit_m(const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                        const FreeColumns& free_motion) const;
  void add_turned_tie(const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion,
                      Eigen::Matrix3Xd& residual_n, FreeColumns& free_n) const;
  void add_push_at_edge(const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                        Eigen::Matrix3Xd& residual_n) const;
  static void add_back(const ContactTouch& touch, const Eigen::Vector3d& force_n, FreeColumns& forces);

  std::vector<Obstacle> obstacles_;
  std::vector<ContactReading> nothing_;  // readings of what does not touch: all obstacles, then pairs of bodies
  std::vector<int> first_anchor_;        // per obstacle; -1 without friction
  int anchor_count_ = 0;
  ContactPoints points_;  // against obstacles
  SkinContact skin_;
  Eigen::VectorXd moduli_pa_;  // of the points' faces
  FreeObstacles free_;
  RigidContact rigid_;
};

}  // namespace soft_robot_lab
