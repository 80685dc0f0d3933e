// SPDX-License-Identifier: BSD-3-Clause
// Contact in the substeps of xpbd: the points and laws of ContactTerm, as constraints of eq. 18 one after another. A
// point's push P >= 0 follows its gap g, and with friction its pull T along the surface how far it stands off its
// anchor u, with compliances a and c:
//   dP = -(g + a P) / (a + h^2 W)      dT = (u - c T) / (c + h^2 W),  then |T| <= mu P      W: inverse mass of the
//   point
// Both live from substep to substep as the elements' multipliers do. They are many, lie close and are stiff, so a sweep
// takes all of them several times. Free obstacles move with the points that they touch, and so do the places where they
// touch others.
//
// Skin may be seen deep in other skin at once, as where an edge slips off a face. It comes out no faster than by
// kRecovery times the speed of sound in a thread of the silicone: else it would fly apart.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "free_sweep.h"
#include "mechanics/contact/contact_term.h"

namespace soft_robot_lab {

class ContactSweep {
 public:
  // Where a step begins: what touches, and how it pushes. All outlive the step.
  ContactSweep(const ContactTerm& contact, const Body& body, const Eigen::Matrix3Xd& inverse_masses_per_kg,
               const Eigen::Matrix3Xd& positions_m, const ContactState& state);

  // Where a substep of length h begins: what it pushes the nodes by in that, as it does now; and the way of free
  // obstacles.
  void begin(double h, const ContactState& state, const FreeVelocities& velocities, Eigen::Matrix3Xd& motion_m);

  // Finds what touches at the end of the inertia's way, and sweeps over it.
  void find(const Eigen::Matrix3Xd& start_m, const Eigen::Matrix3Xd& positions_m, ContactState& state);
  void sweep(Eigen::Matrix3Xd& positions_m);

  // Where a substep ends: puts pressures and free obstacles into the state, and returns the work done on the nodes.
  // What has slipped stays behind.
  double finish(const Eigen::Matrix3Xd& start_m, const Eigen::Matrix3Xd& end_m, ContactState& state,
                FreeVelocities& velocities);
  const FreeObstacles& free() const { return contact_.free(); }
  std::shared_ptr<const FreeInertia> free_inertia() const { return free_.inertia(); }  // of the substep

 private:
  // Of skin, or of two obstacles of which one is free.
  struct Point {
    int pair = 0, node_count = 0;
    double recovery_m_s = -1.0;  // of skin on skin; else negative
    std::array<int, 12> nodes{};
    std::array<double, 12> shares{};  // of the point's motion against what it touches
    // Free obstacles that move with the point, and with what it touches; -1: none. From their centres to there.
    int pushed = -1, pushing = -1;
    Eigen::Vector3d pushed_arm_m = Eigen::Vector3d::Zero(), pushing_arm_m = Eigen::Vector3d::Zero();
    double weight_m2 = 1.0, gap_m = 0.0, compliance_m_n = 0.0, push_n = 0.0;
    double friction = 0.0, tie_m_n = 0.0;  // coefficient, compliance; of friction
    Eigen::Vector3d normal;
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  // of its nodes' part; it and the gap: where it was found
    Eigen::Matrix3d inverse_mass_per_kg;
    Eigen::Vector3d away_m = Eigen::Vector3d::Zero();     // from the anchor, where it was found,
    Eigen::Vector3d slipped_m = Eigen::Vector3d::Zero();  // of which so much has slipped in this step
    Eigen::Vector3d pull_n = Eigen::Vector3d::Zero();     // back to the anchor

    Eigen::Vector3d along(const Eigen::Vector3d& way) const { return way - normal * normal.dot(way); }
    Eigen::Vector3d at(const Eigen::Matrix3Xd& columns) const;  // its nodes' part
    Eigen::Vector3d force_n() const { return push_n * normal - pull_n; }
  };

  std::vector<Point> touching(const Eigen::Matrix3Xd& positions_m, const ContactState& state) const;
  Point point_of(const ContactTouch& touch, const Eigen::Matrix3Xd& positions_m) const;
  Point point_of(Eigen::Index rigid_pair, const RigidTouch& touch) const;
  void carry_over(const Point& before, Point& point) const;
  Eigen::Vector3d way_m(const Point& point, const Eigen::Matrix3Xd& positions_m) const;  // since it was found
  Eigen::Vector3d off_m(const Point& point, const Eigen::Matrix3Xd& positions_m) const;  // the anchor
  void weigh(Point& point) const;
  void move(const Point& point, const Eigen::Vector3d& force_n, Eigen::Matrix3Xd& positions_m);
  void push(Point& point, Eigen::Matrix3Xd& positions_m);
  void rub(Point& point, Eigen::Matrix3Xd& positions_m);

  const ContactTerm& contact_;
  const Eigen::Matrix3Xd& inverse_masses_;
  double density_kg_m3_;  // of a thread along which skin recovers
  int skin_pairs_;        // pairs from there on are of RigidContact
  double h_ = 0.0;        // of the substep
  FreeSweep free_;
  std::vector<Point> points_;  // in the order of their pairs
};

}  // namespace soft_robot_lab
