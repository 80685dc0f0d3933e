// SPDX-License-Identifier: BSD-3-Clause
// Bodies for tests of contact.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "mechanics/box_mesh.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

inline const Eigen::Vector3d kZero = Eigen::Vector3d::Zero();
inline const Material kSilicone{264200.0, 0.49, 1070.0};

// Plane strain: a slab from z = 0 to 10 mm that keeps its thickness.
inline void hold_slab(Body& body) {
  body.fix_nodes({-1, -1, -1e-6}, {1, 1, 1e-6}, {false, false, true});
  body.fix_nodes({-1, -1, 0.009999}, {1, 1, 0.010001}, {false, false, true});
}

// 40 x 20 x 40 mm, with its foot at y = 0, held by nothing.
inline Body loose_block(const Eigen::Vector3i& cells = {4, 2, 4}) {
  return Body(box_mesh({-0.02, 0, -0.02}, {0.02, 0.02, 0.02}, cells), kSilicone);
}

inline SolverOptions xpbd(int substep_count, double time_step_s = 1.0 / 60.0) {
  SolverOptions options;
  options.method = SolverOptions::Method::xpbd;
  options.substep_count = substep_count;
  options.time_step_s = time_step_s;
  options.tolerance = 1e-4;
  return options;
}

inline Eigen::Vector3d middle_m(const Simulation& simulation) {
  const Eigen::VectorXd& masses_kg = simulation.body().node_masses_kg();
  return simulation.state().positions_m * masses_kg / masses_kg.sum();
}

}  // namespace soft_robot_lab
