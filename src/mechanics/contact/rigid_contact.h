// SPDX-License-Identifier: BSD-3-Clause
// Free obstacles against other obstacles: fixed, moved or free. A free one touches by balls inside it that its surface
// rounds off: a sphere's own, those of a capsule's axis, of a box's corners, of a cylinder's edges. Each obeys the laws
// of the skin's contact points, with forces for pressures. Ball against plane is exact; so is every shape on a plane
// but the cylinder, whose edges are polygons of 24.
//
// Such a point is no place of the material: a ball rolls over it. So friction's tie is remembered as how far it stands
// off, and grows by how the materials move against each other there.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "free_obstacles.h"
#include "friction_law.h"
#include "normal_law.h"
#include "soft_robot_lab/mechanics/obstacle.h"

namespace soft_robot_lab {

struct RoundedPoint {
  Eigen::Vector3d position_m;  // of the shape as stated
  double radius_m;
};

std::vector<RoundedPoint> rounded_points(const ObstacleShape& shape);

struct RigidTouch {
  int pair = 0;
  bool closed = false;
  double gap_m = 0.0, force_n = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();      // of the other, towards the free one
  Eigen::Matrix3d bend = Eigen::Matrix3d::Zero();        // second derivative of the gap, by the ball's centre
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // where they touch
  Eigen::Vector3d arm_m = Eigen::Vector3d::Zero(), other_arm_m = Eigen::Vector3d::Zero();  // from their centres
  FrictionLaw friction{0.0, -1.0};                                                         // per force
  Eigen::Vector3d off_m = Eigen::Vector3d::Zero();                                         // of the tie

  bool rubs() const { return friction.limit_pa >= 0.0; }
  bool at_limit() const { return closed && friction.limit_pa > 0.0 && friction.at_limit(along(off_m)); }
  Eigen::Vector3d along(const Eigen::Vector3d& way_m) const { return way_m - normal * normal.dot(way_m); }
  Eigen::Vector3d traction_n() const { return rubs() ? friction.traction_pa(along(off_m)) : Eigen::Vector3d::Zero(); }
};

using RigidTouches = std::vector<RigidTouch>;  // one per pair

// From sums over forces to means.
void finish(ContactReading& reading);

class RigidContact {
 public:
  RigidContact() = default;  // none
  RigidContact(const std::vector<Obstacle>& obstacles, const FreeObstacles& free, double youngs_modulus_pa);

  Eigen::Index pair_count() const { return static_cast<Eigen::Index>(pairs_.size()); }

  RigidTouches touches(const ContactState& state) const;
  double mismatch(const RigidTouches& at) const;  // the largest, over the obstacle's size

  // What stands in the residual, and what condensation adds to it.
  void add_forces(const RigidTouches& at, FreeColumns& residual) const;
  void add_mismatch_forces(const RigidTouches& linearised, const RigidTouches& here, FreeColumns& residual) const;
  void add_beyond(const RigidTouches& at, FreeColumns& residual) const;
  void add_hessian(const RigidTouches& at, bool convex, Eigen::MatrixXd& matrix) const;  // over the free columns

  // As ContactTerm's, of one at the limit of friction; and what the matrix of all lacks of their derivatives at rest.
  void add_slip(const RigidTouch& touch, FreeColumns& residual) const;
  double beyond_limit_m(const RigidTouch& touch, const FreeColumns& motion) const;
  void add_turned(const RigidTouches& at, const FreeColumns& motion, FreeColumns& residual) const;
  static bool same_set(const RigidTouches& a, const RigidTouches& b);

  // As ContactTerm's.
  Eigen::VectorXd next_forces_n(const RigidTouches& linearised, const RigidTouches& here,
                                const FreeColumns& motion) const;
  double merit_j(const RigidTouches& at, const RigidTouches& start, const Eigen::VectorXd& next_n) const;
  double slope_change_j(const RigidTouches& start, const Eigen::VectorXd& next_n, const FreeColumns& motion) const;
  void commit(ContactState& state) const;
  double rubbed_j(const RigidTouches& at) const;

  // One for each free obstacle and each other that it touches.
  std::vector<ContactReading> readings(const ContactState& state) const;

  // Of a pair: who among the free presses on whom (-1: on one that is not free), and by which laws.
  int free_of(Eigen::Index pair) const { return pairs_[static_cast<std::size_t>(pair)].free; }
  int other_free_of(Eigen::Index pair) const { return pairs_[static_cast<std::size_t>(pair)].other_free; }
  NormalLaw law_of(Eigen::Index pair) const { return law(pairs_[static_cast<std::size_t>(pair)]); }
  double friction_of(Eigen::Index pair) const { return pairs_[static_cast<std::size_t>(pair)].friction; }
  // Throws std::invalid_argument where a free obstacle is inside another one at the start: which, how deep.
  void refuse_overlap() const;

 private:
  struct Pair {
    int free, obstacle, other, other_free;  // the first and the last among the free, -1: not free
    RoundedPoint point;
    double size_m, friction;
  };
  NormalLaw law(const Pair& pair) const { return NormalLaw::of_skin(pair.size_m, youngs_modulus_pa_); }
  Eigen::Isometry3d pose(int obstacle, const FreePoses& poses, double time_s) const;
  RigidTouch touch(std::size_t index, const ContactState& state) const;
  Eigen::Vector3d relative_motion_m(const Pair& pair, const RigidTouch& touch, const FreeColumns& motion) const;
  // How the normal turns, and RigidTouch::off_m changes along the surface, where nothing has moved since the last step.
  Eigen::Vector3d normal_motion(const Pair& pair, const RigidTouch& touch, const FreeColumns& motion) const;
  Eigen::Vector3d along_motion_m(const Pair& pair, const RigidTouch& touch, const FreeColumns& motion) const;
  void add_at(const Pair& pair, const RigidTouch& touch, const Eigen::Vector3d& force_n, FreeColumns& forces) const;

  std::vector<Obstacle> obstacles_;
  FreeObstacles free_;
  std::vector<Pair> pairs_;
  double youngs_modulus_pa_ = 1.0;
};

}  // namespace soft_robot_lab
