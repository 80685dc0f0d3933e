// SPDX-License-Identifier: BSD-3-Clause
// Contact in the substeps of xpbd: the points and laws of ContactTerm, as constraints of eq. 18 one after another. A
// point's push P >= 0 follows its gap g, and with friction its pull T along the surface how far it stands off its
// anchor u, with compliances a and c:
//   dP = -(g + a P) / (a + h^2 W)      dT = (u - c T) / (c + h^2 W),  then |T| <= mu P      W: inverse mass of the
//   point
// Both live from substep to substep as the elements' multipliers do. They are many, lie close and are stiff, so a sweep
// takes all of them several times.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "mechanics/contact/contact_term.h"

namespace soft_robot_lab {

class ContactSweep {
 public:
  // Where a step begins: what touches, and how it pushes. Both outlive the step.
  ContactSweep(const ContactTerm& contact, const Eigen::Matrix3Xd& inverse_masses_per_kg,
               const Eigen::Matrix3Xd& positions_m, const ContactState& state);

  // What it pushes the nodes by in a substep of length h, as it does now.
  void add_motion(double h, Eigen::Matrix3Xd& motion_m) const;

  // Finds what touches at the end of the inertia's way, and sweeps over it.
  void find(const Eigen::Matrix3Xd& positions_m, const ContactState& state);
  void sweep(double h, Eigen::Matrix3Xd& positions_m);

  // Where a substep ends: puts the pressures into the state, and returns the work done on the nodes. `slips`: what has
  // slipped stays behind; else it is still measured from where it stuck when the step began.
  double finish(const Eigen::Matrix3Xd& start_m, const Eigen::Matrix3Xd& end_m, bool slips, ContactState& state);

 private:
  struct Point {
    int pair = 0, node_count = 0;
    std::array<int, 12> nodes{};
    std::array<double, 12> shares{};  // of the point's motion against what it touches
    double weight_m2 = 0.0, gap_m = 0.0, compliance_m_n = 0.0, push_n = 0.0;
    double friction = 0.0, tie_m_n = 0.0;                     // coefficient, compliance; of friction
    Eigen::Vector3d normal, position_m, inverse_mass_per_kg;  // position and gap: where it was found
    Eigen::Vector3d away_m = Eigen::Vector3d::Zero();         // from the anchor, where it was found,
    Eigen::Vector3d slipped_m = Eigen::Vector3d::Zero();      // of which so much has slipped in this step
    Eigen::Vector3d pull_n = Eigen::Vector3d::Zero();         // back to the anchor

    Eigen::Vector3d along(const Eigen::Vector3d& way) const { return way - normal * normal.dot(way); }
    Eigen::Vector3d at(const Eigen::Matrix3Xd& columns) const;
    // By a force, in a substep of length h; `inverse_masses` of nodes.
    void move(const Eigen::Vector3d& force_n, double h, const Eigen::Matrix3Xd& inverse_masses,
              Eigen::Matrix3Xd& positions_m) const;
    Eigen::Vector3d force_n() const { return push_n * normal - pull_n; }
    Eigen::Vector3d off_m(const Eigen::Matrix3Xd& positions_m) const;  // the anchor
  };

  Point point_of(const ContactTouch& touch, const Eigen::Matrix3Xd& positions_m) const;
  void push(Point& point, double h, Eigen::Matrix3Xd& positions_m) const;
  void rub(Point& point, double h, Eigen::Matrix3Xd& positions_m) const;

  const ContactTerm& contact_;
  const Eigen::Matrix3Xd& inverse_masses_;
  std::vector<Point> points_;  // in the order of their pairs
};

}  // namespace soft_robot_lab
