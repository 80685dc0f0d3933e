// SPDX-License-Identifier: BSD-3-Clause
// The energy of a body's fibres (FibreGroup). With e, the mean stretch of a group less one, and L its length at rest:
//   E A L t^2 / 2,   t = e, but of threads that cannot push, max(e, 0)
// A group's tension T is a multiplier of its own beside the elements' pressures, with t in place of Jbar - 1, E A in
// place of lambda and L in place of V0; as there, Newton's method then takes as few steps for threads that hardly
// stretch. Which of them are taut is an active set (Hintermueller, Ito and Kunisch 2002): where T + s e >= 0, s being
// the stiffness of the silicone around. At rest they are, so they are as stiff there as under tension.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "clique_adder.h"
#include "mechanics/linear_algebra/block_matrix.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

class FibreMultipliers {
 public:
  FibreMultipliers(const Body& body, const BlockPattern& matrix);

  Eigen::Index count() const { return lengths_m_.size(); }
  const Eigen::VectorXd& lengths_m() const { return lengths_m_; }              // L, per group
  const Eigen::VectorXd& stiffnesses_n() const { return stiffnesses_n_; }      // E A
  const Eigen::VectorXd& soft_stiffnesses_n() const { return softnesses_n_; }  // of silicone where the group is

  // What the last Hessian was made of, per group: L de/dx of the element's nodes, and 1 where it was taut, else 0.
  struct Gradients {
    std::vector<Eigen::Matrix3Xd> ways;
    Eigen::VectorXd slopes;
  };

  // Adds T L de/dx to the forces; writes t.
  void add_gradient(const Eigen::Matrix3Xd& positions_m, const double* tensions_n, Eigen::Matrix3Xd& forces_n,
                    double* strains) const;
  // `stiffnesses_n`: E A, or what stands in for it.
  void add_hessian(const Eigen::Matrix3Xd& positions_m, const double* stiffnesses_n, const double* tensions_n,
                   bool convex, BlockMatrix& matrix, Gradients& gradients) const;
  void add_forces(const Gradients& gradients, const Eigen::VectorXd& tensions_n, Eigen::Matrix3Xd& forces_n) const;
  // L dt along a step.
  Eigen::VectorXd changes(const Gradients& gradients, const Eigen::Matrix3Xd& step) const;

 private:
  struct Group {
    std::vector<int> nodes;
    Eigen::MatrixXd weights;  // FibreGroup
    bool only_tension;
  };

  bool taut(Eigen::Index group, double strain, double tension_n) const {
    return !groups_[static_cast<std::size_t>(group)].only_tension || tension_n + softnesses_n_[group] * strain >= 0.0;
  }

  std::vector<Group> groups_;
  Eigen::VectorXd lengths_m_, stiffnesses_n_, softnesses_n_;
  CliquePlaces places_;
};

}  // namespace soft_robot_lab
