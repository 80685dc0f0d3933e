// SPDX-License-Identifier: BSD-3-Clause
// What holds a body, all holds together.
#pragma once

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

struct Reaction {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment_nm = Eigen::Vector3d::Zero();  // about the origin of robot_base
};

// Of Simulation::reaction_forces_n(), at the present places of the nodes.
inline Reaction total_reaction(const Simulation& simulation, const Eigen::Matrix3Xd& forces_n) {
  const Eigen::Matrix3Xd& positions_m = simulation.state().positions_m;
  Reaction total;
  total.force_n = forces_n.rowwise().sum();
  for (Eigen::Index node = 0; node < forces_n.cols(); ++node)
    total.moment_nm += Eigen::Vector3d(positions_m.col(node)).cross(Eigen::Vector3d(forces_n.col(node)));
  return total;
}

}  // namespace soft_robot_lab
