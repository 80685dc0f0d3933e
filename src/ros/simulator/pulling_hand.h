// SPDX-License-Identifier: BSD-3-Clause
// A hand that pulls at the simulated skin, as messages ask for it.
#pragma once

#include <optional>

#include <soft_robot_lab/SkinPull.h>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

class PullingHand {
 public:
  static constexpr double kStiffest_n_m = 1000.0;

  explicit PullingHand(double largest_n) : largest_n_(largest_n) {}

  // `pull` is in robot_base. The first message takes hold of the skin, further ones change force and spring, and
  // neither lets go. `now_s` never goes back. Throws std::invalid_argument where a number is not finite, the stiffness
  // is not in [0, kStiffest_n_m], or the skin is farther off than a tenth of the body's size; then nothing changes.
  void take(const SkinPull& pull, double now_s, Simulation& simulation);
  // A step of the simulation in which the spring pulls by its stiffness times the way from the place that is held, as
  // it is at the step's end, to the hand: found by a second try, as a spring by the step's start would shake a soft
  // body.
  SolveReport step(Simulation& simulation);

  void let_go(Simulation& simulation);
  void let_go_if_silent(double now_s, Simulation& simulation);
  bool holds() const { return hold_.has_value(); }
  void forget() { hold_.reset(); }  // the simulation is another one

 private:
  void pull(const Eigen::Vector3d& force_n, Simulation& simulation);
  Eigen::Matrix3d measured_yield_m_n(Simulation& simulation) const;
  Eigen::Vector3d asked_n(const Eigen::Vector3d& position_m) const;

  double largest_n_;
  std::optional<EmbeddedPoint> hold_;
  Eigen::Vector3d force_n_ = Eigen::Vector3d::Zero(), hand_m_ = Eigen::Vector3d::Zero();
  double stiffness_n_m_ = 0.0;
  Eigen::Matrix3d yield_m_n_ = Eigen::Matrix3d::Zero();  // how far a force moves that place within a step
  Eigen::Vector3d acting_n_ = Eigen::Vector3d::Zero();
  double heard_s_ = 0.0;
};

}  // namespace soft_robot_lab
