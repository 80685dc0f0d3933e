// SPDX-License-Identifier: BSD-3-Clause
// Free obstacles against other obstacles: fixed, moved or free. They touch at places of both (rigid_places.h), each of
// which obeys laws like the skin's contact points, with forces for pressures.
//
// Such a place is none of the material: a ball rolls over it. So friction's tie is remembered as how far it stands
// off, and grows by how the materials move against each other there.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "mechanics/body/free_obstacles.h"
#include "friction_law.h"
#include "normal_law.h"
#include "mechanics/body/rigid_places.h"
#include "soft_robot_lab/mechanics/obstacle.h"

namespace soft_robot_lab {

struct RigidTouch {
  int pair = 0;
  bool closed = false;
  double gap_m = 0.0, force_n = 0.0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();      // of the other, towards the one
  Eigen::Matrix3d bend = Eigen::Matrix3d::Zero();        // RigidMeeting::bend
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // where they touch
  Eigen::Vector3d arm_m = Eigen::Vector3d::Zero(), other_arm_m = Eigen::Vector3d::Zero();  // from their centres
  FrictionLaw friction{0.0, -1.0};                                                         // per force
  Eigen::Vector3d off_m = Eigen::Vector3d::Zero();                                         // of the tie
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity(), other_pose = Eigen::Isometry3d::Identity();

  bool rubs() const { return friction.limit_pa >= 0.0; }
  bool at_limit() const { return closed && friction.limit_pa > 0.0 && friction.at_limit(along(off_m)); }
  Eigen::Vector3d along(const Eigen::Vector3d& way_m) const { return way_m - normal * normal.dot(way_m); }
  Eigen::Vector3d traction_n() const { return rubs() ? friction.traction_pa(along(off_m)) : Eigen::Vector3d::Zero(); }
};

using RigidTouches = std::vector<RigidTouch>;  // of pairs that are near, in their order

// From sums over forces to means.
void finish(ContactReading& reading);

class RigidContact {
 public:
  RigidContact() = default;  // none
  RigidContact(const std::vector<Obstacle>& obstacles, const FreeObstacles& free);

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

  // One for each two obstacles of which one is free.
  std::vector<ContactReading> readings(const ContactState& state) const;

  // Of a pair: who among the free touches whom (-1: one that is not free), and by which laws.
  int free_of(Eigen::Index pair) const { return pairs_[static_cast<std::size_t>(pair)].free; }
  int other_of(Eigen::Index pair) const { return pairs_[static_cast<std::size_t>(pair)].other; }  // of all obstacles
  int other_free_of(Eigen::Index pair) const { return pairs_[static_cast<std::size_t>(pair)].other_free; }
  NormalLaw law_of(Eigen::Index pair) const { return law(pairs_[static_cast<std::size_t>(pair)]); }
  double friction_of(Eigen::Index pair) const { return pairs_[static_cast<std::size_t>(pair)].friction; }

 private:
  struct Pair {
    int free, obstacle, other, other_free;  // the first and the last among the free, -1: not free
    RigidPlace place;
    double size_m, lighter_kg, friction;
  };
  static NormalLaw law(const Pair& pair) { return NormalLaw::of_rigid(pair.lighter_kg); }
  bool begins(std::size_t pair) const;
  Eigen::Isometry3d pose(int obstacle, const FreePoses& poses, double time_s) const;
  PlacedShape placed(int obstacle, const FreePoses& poses, double time_s) const;
  RigidTouch touch(std::size_t index, const ContactState& state) const;
  Eigen::Vector3d relative_motion_m(const Pair& pair, const RigidTouch& touch, const FreeColumns& motion) const;
  std::optional<RigidMeeting> meeting(const Pair& pair, const Eigen::Isometry3d& pose,
                                      const Eigen::Isometry3d& other_pose) const;
  bool apart(const Pair& pair, const FreePoses& poses, double time_s) const;  // by the spheres around both
  // How the normal turns, the place moves, and RigidTouch::off_m changes along the surface, where nothing has moved
  // since the last step.
  struct PlaceMotion {
    Eigen::Vector3d turn, moves_m, along_m;
  };
  PlaceMotion place_motion(const RigidTouch& touch, const FreeColumns& motion) const;
  void add_at(const Pair& pair, const RigidTouch& touch, const Eigen::Vector3d& force_n, FreeColumns& forces) const;

  std::vector<Obstacle> obstacles_;
  FreeObstacles free_;
  std::vector<Pair> pairs_;
};

}  // namespace soft_robot_lab
