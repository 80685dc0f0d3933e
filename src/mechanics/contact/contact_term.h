// SPDX-License-Identifier: BSD-3-Clause
// Contact of a body's skin with rigid obstacles and with itself, as a term of Newton's method: what it adds to the
// residual, the matrix, the step, and the merit function. What changes is ContactState; of its own it only remembers
// which skin is near which, so an object serves one thread.
//
// Pressures are unknowns of their own, condensed point by point as the elements' volumes are: with g the gap, n its
// gradient, a the compliance, w the weight and N the shape functions of a closed point
//   residual  - w l n N     matrix  w / a (n n') N N' - w l (grad grad g) N N'     l+ = max(0, -(g + n.dx) / a)
// All nodes of a face are in one element, so the pattern of the matrix stays. A point of the skin that meets other skin
// pushes the closest place y of that face back; n is the face's normal there, g = n . (x - y), and with the tangents
// t_a, their duals t^a and the curvature k (Wriggers 2006, 6.4, at g = 0)
//   d2g = - (n . dy,a) t^a . (dx - dy) - its transpose - k (dx - dy) (dx - dy)
// Both faces are in the matrix then, so its pattern grows (ContactMatrix).
//
// A free obstacle is pushed back by what touches it. Its motion stands beside that of the nodes, in FreeColumns, and
// the couplings of the two are columns of a border (FreeBorder).
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "contact_points.h"
#include "free_obstacles.h"
#include "friction_law.h"
#include "normal_law.h"
#include "rigid_contact.h"
#include "skin_pairs.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/mechanics/constraint.h"
#include "soft_robot_lab/mechanics/obstacle.h"

namespace soft_robot_lab {

// A contact point at a surface that it presses against, or nearly: an obstacle, or after all obstacles the skin.
struct ContactTouch {
  int pair = 0;         // surface * points + point
  bool closed = false;  // NormalLaw::closed
  double gap_m = 0.0, pressure_pa = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  // Of an obstacle, the second derivative of the gap; of skin, its curvature.
  Eigen::Matrix3d bend = Eigen::Matrix3d::Zero();
  SkinPlace met;                                    // of skin
  int free = -1;                                    // the obstacle among the free; -1: it is not
  Eigen::Vector3d arm_m = Eigen::Vector3d::Zero();  // from that one's centre
  // Of friction; without any the limit is negative.
  FrictionLaw friction{0.0, -1.0};
  Eigen::Vector3d anchor_m = Eigen::Vector3d::Zero();  // where the obstacle now has it
  Eigen::Vector3d away_m = Eigen::Vector3d::Zero();    // from there, along the surface

  bool rubs() const { return friction.limit_pa >= 0.0; }
  bool on_skin() const { return met.face >= 0; }
};

// Contact at some positions and pressures.
struct ContactSums {
  std::vector<ContactTouch> touches;  // all with pressure or penetration, and the closed ones
  Eigen::Matrix3Xd points_m;          // where all contact points are
  double mismatch = 0.0;              // the largest, over the size of its face
  FreePoses free;
  RigidTouches rigid;
};

class ContactTerm {
 public:
  explicit ContactTerm(const Body& body);

  bool empty() const { return surface_count() == 0; }
  double end_of_motion_s() const;                        // of all obstacles
  bool moves_between(double from_s, double to_s) const;  // whether any does
  std::vector<Clique> cliques() const;                   // for add_hessian: the faces
  const ContactPoints& points() const { return points_; }
  const SkinPairs& skin() const { return skin_; }
  FacePair faces_of(const ContactTouch& touch) const;  // of one on skin
  const FreeObstacles& free() const { return free_; }
  const RigidContact& rigid() const { return rigid_; }
  Eigen::Isometry3d pose_of(int obstacle, const ContactState& state) const;  // from its shape as stated

  // Of a body at these positions that did not touch anything before.
  ContactState untouched(const Eigen::Matrix3Xd& positions_m, double time_s) const;

  ContactSums sums(const Eigen::Matrix3Xd& positions_m, const ContactState& state) const;
  void add_forces(const ContactSums& at, Eigen::Matrix3Xd& residual_n) const;
  FreeColumns free_forces_n(const ContactSums& at) const;  // the same on free obstacles

  // Of obstacles. `convex` leaves out what may make the matrix indefinite; `soft` is for soft_energy.
  void add_hessian(const std::vector<ContactTouch>& touches, bool convex, bool soft, CliqueSink& matrix) const;
  // Of one that is closed on skin, over the nodes of both faces.
  Eigen::MatrixXd skin_hessian(const ContactTouch& touch, bool convex, bool soft) const;
  // Of free obstacles: with the nodes, 3*node + axis x columns, and among themselves.
  void add_free_hessian(const std::vector<ContactTouch>& touches, bool convex, Eigen::MatrixXd& border,
                        Eigen::MatrixXd& own) const;

  // Whether the matrix of these touches may serve others: the same are closed, on the same faces. What sticks and what
  // slips may differ.
  static bool same_set(const std::vector<ContactTouch>& a, const std::vector<ContactTouch>& b);

  // What condensation adds to the residual; `linearised`: the touches the matrix was made of.
  void add_mismatch_forces(const std::vector<ContactTouch>& linearised, const ContactSums& here,
                           Eigen::Matrix3Xd& forces_n) const;
  FreeColumns free_mismatch_forces_n(const std::vector<ContactTouch>& linearised, const ContactSums& here) const;
  Eigen::VectorXd next_pressures_pa(const std::vector<ContactTouch>& linearised, const ContactSums& here,
                                    const Eigen::Matrix3Xd& motion_m, const FreeColumns& free_motion) const;
  // Per pair: NormalLaw::mismatch_m over the size of the face.
  Eigen::VectorXd mismatches(const ContactSums& at) const;

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
  int surface_count() const { return static_cast<int>(obstacles_.size()) + (touches_itself_ ? 1 : 0); }
  Eigen::Index pair_count() const { return static_cast<Eigen::Index>(surface_count()) * points_.count(); }
  NormalLaw law(int pair) const;
  double weight_m2(int pair) const { return points_.weight_m2(point_of(pair)); }
  int point_of(int pair) const { return pair % points_.count(); }
  const Obstacle& obstacle_of(int pair) const { return obstacles_[static_cast<std::size_t>(pair / points_.count())]; }
  Eigen::Matrix3Xd all_points(const Eigen::Matrix3Xd& positions_m) const;
  void find_touches(int obstacle, const ContactState& state, ContactSums& sums) const;
  void find_skin_touches(const Eigen::Matrix3Xd& positions_m, const ContactState& state, ContactSums& sums) const;
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
  static void add_back(const ContactTouch& touch, const Eigen::Vector3d& force_n, FreeColumns& forces);

  std::vector<Obstacle> obstacles_;
  bool touches_itself_;
  std::vector<int> first_anchor_;  // per obstacle; -1 without friction
  ContactPoints points_;
  mutable SkinPairs skin_;
  double youngs_modulus_pa_;
  FreeObstacles free_;
  RigidContact rigid_;
};

}  // namespace soft_robot_lab
