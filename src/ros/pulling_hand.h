// SPDX-License-Identifier: BSD-3-Clause
// A hand that pulls at the simulated skin, as messages ask for it.
#pragma once

#include <optional>

#include <soft_robot_lab/SkinPull.h>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

class PullingHand {
 public:
  explicit PullingHand(double largest_n) : largest_n_(largest_n) {}

  // `point_m` is in robot_base. The first message takes hold of the skin, further ones change the force, and zero lets
  // go. `now_s` never goes back. Throws std::invalid_argument where point or force are not finite, or where the skin is
  // farther off than a tenth of the body's size; then nothing changes.
  void take(const SkinPull& pull, const Eigen::Vector3d& point_m, double now_s, Simulation& simulation);

  void let_go(Simulation& simulation);
  void let_go_if_silent(double now_s, Simulation& simulation);
  void forget() { hold_.reset(); }  // the simulation is another one

 private:
  double largest_n_;
  std::optional<EmbeddedPoint> hold_;
  double heard_s_ = 0.0;
};

}  // namespace soft_robot_lab
