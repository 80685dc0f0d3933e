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

// A force on a touch, back on the free obstacle that it touches.
void add_back(const ContactTouch& touch, const Eigen::Vector3d& force_n, FreeColumns& forces);

class ContactTerm {
 public:
  explicit ContactTerm(const Body& body);

  bool empty() const { return obstacles_.empty() && skin_.pair_count() == 0; }
  Eigen::Index pair_count() const { return obstacle_pairs() + skin_.points().count(); }  // of points and surfaces
  std::vector<Clique> cliques() const;                                                   // for add_hessian: the faces
  const ContactPoints& points() const { return points_; }                                // of obstacles
  const SkinContact& skin() const { return skin_; }
  SkinContact& skin() { return skin_; }
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

  // Of a touch, or its pair.
  int point_of(int pair) const { return of_skin(pair) ? pair - obstacle_pairs() : pair % points_.count(); }
  NormalLaw law(const ContactTouch& touch) const;
  double weight_m2(int pair) const { return points_of(pair).weight_m2(point_of(pair)); }
  double friction_of(const ContactTouch& touch) const {  // Coulomb's coefficient
    return touch.on_skin() ? skin_.friction(touch) : obstacle_of(touch.pair).friction;
  }
  double face_size_m(const ContactTouch& touch) const {
    return points_of(touch.pair).face_size_m(point_of(touch.pair));
  }
  // The nodes of the face, and of skin that it meets, with their shares of how the point moves against that; their
  // number.
  int nodes_of(const ContactTouch& touch, std::array<int, 12>& nodes, std::array<double, 12>& shares) const;
  // How a point moves against what it touches.
  Eigen::Vector3d relative_motion_m(const ContactTouch& touch, const Eigen::Matrix3Xd& motion_m,
                                    const FreeColumns& free_motion) const;
  // A force on the point, and back on the skin that it meets.
  void add_at(const ContactTouch& touch, const Eigen::Vector3d& force_n, Eigen::Matrix3Xd& forces_n) const;

  // Lets anchors follow what slipped, and what does not touch.
  void commit(const Eigen::Matrix3Xd& positions_m, ContactState& state) const;

  std::vector<ContactReading> readings(const Eigen::Matrix3Xd& positions_m, const ContactState& state) const;

 private:
  ContactReading& reading_of(const ContactTouch& touch, std::vector<ContactReading>& all) const;
  int obstacle_pairs() const { return static_cast<int>(obstacles_.size()) * points_.count(); }
  NormalLaw law_on_obstacle(int point) const;
  bool of_skin(int pair) const { return pair >= obstacle_pairs(); }
  const ContactPoints& points_of(int pair) const { return of_skin(pair) ? skin_.points() : points_; }
  int face_of(int pair) const { return points_of(pair).face_of(point_of(pair)); }
  double slack_m(int pair) const { return of_skin(pair) ? skin_.slack_m(point_of(pair)) : 0.0; }
  const Obstacle& obstacle_of(int pair) const { return obstacles_[static_cast<std::size_t>(pair / points_.count())]; }
  Eigen::Matrix3Xd all_points(const Eigen::Matrix3Xd& positions_m) const;
  void find_touches(int obstacle, const Eigen::Matrix3Xd& positions_m, const ContactState& state,
                    ContactSums& sums) const;
  void add_friction(const Eigen::Isometry3d& pose, int obstacle, const ContactState& state, const ContactSums& sums,
                    ContactTouch& touch) const;
  Eigen::Vector3d force_n(const ContactTouch& touch) const;  // as in the residual

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
