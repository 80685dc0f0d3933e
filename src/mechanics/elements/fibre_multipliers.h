// SPDX-License-Identifier: BSD-3-Clause
// The energy of a body's fibres (FibreGroup). With e, the mean stretch of a group less one, and L its length at rest:
//   E A L phi(e),   phi' = t(e),   t = e, but of threads that cannot push: where e < 0 it falls to -d/2 within d.
// So at rest they are as stiff as under tension, and t has no jump. A group's tension is a multiplier of its own beside
// the elements' pressures, with t(e) in place of Jbar - 1, E A in place of lambda and L in place of V0; as there,
// Newton's method then takes as few steps for threads that hardly stretch.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "clique_adder.h"
#include "mechanics/linear_algebra/block_matrix.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {

// Of threads at a strain: energy per length, tension and stiffness, each over E A.
struct ThreadLaw {
  double energy, tension, slope;
};
ThreadLaw thread_law(double strain, bool only_tension);

class FibreMultipliers {
 public:
  FibreMultipliers(const Body& body, const BlockPattern& matrix);

  Eigen::Index count() const { return lengths_m_.size(); }
  const Eigen::VectorXd& lengths_m() const { return lengths_m_; }              // L, per group
  const Eigen::VectorXd& stiffnesses_n() const { return stiffnesses_n_; }      // E A
  const Eigen::VectorXd& soft_stiffnesses_n() const { return softnesses_n_; }  // of silicone where the group is

  // What the last Hessian was made of, per group: L de/dx of the element's nodes, and t'(e).
  struct Gradients {
    std::vector<Eigen::Matrix3Xd> ways;
    Eigen::VectorXd slopes;
  };

  // Adds T L de/dx to the forces, and E A L (phi - t^2 / 2) to the energy; writes t(e).
  void add_gradient(const Eigen::Matrix3Xd& positions_m, const double* tensions_n, Eigen::Matrix3Xd& forces_n,
                    double& energy_j, double* strains) const;
  // `stiffnesses_n`: E A, or what stands in for it.
  void add_hessian(const Eigen::Matrix3Xd& positions_m, const double* stiffnesses_n, const double* tensions_n,
                   bool convex, BlockMatrix& matrix, Gradients& gradients) const;
  void add_forces(const Gradients& gradients, const Eigen::VectorXd& tensions_n, Eigen::Matrix3Xd& forces_n) const;
  // t' L de along a step.
  Eigen::VectorXd changes(const Gradients& gradients, const Eigen::Matrix3Xd& step) const;

 private:
  struct Group {
    std::vector<int> nodes;
    Eigen::MatrixXd weights;  // FibreGroup
    bool only_tension;
  };

  std::vector<Group> groups_;
  Eigen::VectorXd lengths_m_, stiffnesses_n_, softnesses_n_;
  CliquePlaces places_;
};

}  // namespace soft_robot_lab
