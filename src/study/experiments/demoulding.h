// SPDX-License-Identifier: BSD-3-Clause
// A robot that is pulled out of its mould: force over travel, and how far the silicone is stretched.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/mechanics/simulation.h"
#include "soft_robot_lab/mechanics/tet_mesh.h"

namespace soft_robot_lab {

struct LargestStretch {
  double ratio = 1.0;                              // length over rest length: the largest singular value of F
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();  // in the rest shape
};

// At the four points of second order in each element.
LargestStretch largest_stretch(const TetMesh& rest, const Eigen::Matrix3Xd& positions_m);

// One value for each step in time.
struct DemouldingCurve {
  std::vector<double> travel_m;  // of the held region
  std::vector<double> force_n;   // that lifts it; friction, suction and weight
  std::vector<double> stretch;
  LargestStretch largest;     // of all steps
  double largest_at_m = 0.0;  // travel
  double peak_force_n = 0.0;
  bool converged = true;
  std::string message;  // where it did not
};

// Steps through time while the body's only held region moves along the unit vector `direction`. Throws
// std::invalid_argument where there is another number of held regions.
DemouldingCurve pull_out(Simulation& simulation, const Eigen::Vector3d& direction, double duration_s);

}  // namespace soft_robot_lab
