// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "soft_robot_lab/control/motion/plan_motion.h"

namespace soft_robot_lab {

// A marker that goes 20 mm along x in 10 s, by two commands that move it along x and z.
inline PathPlan straight(double min = 0.5, double max = 1.5) {
  PathPlan plan;
  plan.marker = "tip";
  plan.curve = Curve({{0, 0, 0}, {0.02, 0, 0}});
  plan.drives = {{"left", min, max, 1.0, 0.0}, {"right", min, max, 1.0, 0.0}};
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3, 2);
  jacobian(0, 0) = 0.1;
  jacobian(2, 1) = 0.05;
  for (int k = 0; k <= 10; ++k) {
    PathSample sample;
    sample.time_s = k;
    sample.way_m = 0.002 * k;
    sample.commands = Eigen::Vector2d(1.0 + 0.02 * k, 1.0);
    sample.target_m = sample.aim_m = sample.predicted_m = {0.002 * k, 0, 0};
    sample.jacobian = jacobian;
    plan.samples.push_back(sample);
  }
  plan.complete = true;
  return plan;
}

}  // namespace soft_robot_lab
