// SPDX-License-Identifier: BSD-3-Clause
#include "pulling_hand.h"

#include <sstream>
#include <stdexcept>

#include <Eigen/LU>

#include "ros/messages/conversions.h"
#include "mechanics/mesh/skin.h"
#include "settings/require_in_range.h"

namespace soft_robot_lab {
namespace {

constexpr double silence_s = 1.0;
constexpr double reach = 0.1;          // of the body's size: farther off the skin a point means another robot
constexpr double fingertip_m = 0.003;  // radius over which the force spreads

EmbeddedPoint hold_at(const Eigen::Vector3d& point_m, const Simulation& simulation) {
  const TetMesh& mesh = simulation.body().mesh();
  const GripPlace place = grip_on_skin(mesh, simulation.state().positions_m, point_m);
  const double farthest_m = reach * simulation.body().size_m();
  if (!(place.distance_m <= farthest_m)) {
    std::ostringstream text;
    text << "point: lies " << place.distance_m << " m off the skin, out of range [0, " << farthest_m << "]";
    throw std::invalid_argument(text.str());
  }
  return MeshLocator(mesh).embed_disc(place.rest_m, place.rest_normal, fingertip_m);
}

}  // namespace

void PullingHand::take(const SkinPull& pull, double now_s, Simulation& simulation) {
  const Eigen::Vector3d force_n = from_message(pull.force, "force"), hand_m = from_message(pull.hand, "hand");
  const Eigen::Vector3d point_m = from_message(pull.point, "point");
  require_in_range("stiffness_n_m", pull.stiffness_n_m, AllowedRange{0.0, kStiffest_n_m});
  if (force_n.isZero(0.0) && pull.stiffness_n_m == 0.0) return let_go(simulation);
  if (!hold_) {
    hold_ = hold_at(point_m, simulation);
    acting_n_.setZero();
    yield_m_n_ = measured_yield_m_n(simulation);
  }
  force_n_ = force_n;
  hand_m_ = hand_m;
  stiffness_n_m_ = pull.stiffness_n_m;
  heard_s_ = now_s;
  if (stiffness_n_m_ == 0.0) this->pull(force_n, simulation);
}

// By small forces, one after the other, through a step that is taken back.
Eigen::Matrix3d PullingHand::measured_yield_m_n(Simulation& simulation) const {
  constexpr double probe_n = 1e-3;
  const SimulationState before = simulation.state();
  const auto position_m = [&](const Eigen::Vector3d& force_n) {
    simulation.pull({{*hold_, force_n}});
    simulation.step();
    const Eigen::Vector3d moved_m = hold_->at(simulation.state().positions_m);
    simulation.set_state(before);
    return moved_m;
  };
  const Eigen::Vector3d free_m = position_m(Eigen::Vector3d::Zero());
  Eigen::Matrix3d yield_m_n;
  for (int axis = 0; axis < 3; ++axis)
    yield_m_n.col(axis) = (position_m(probe_n * Eigen::Vector3d::Unit(axis)) - free_m) / probe_n;
  simulation.pull({});
  return yield_m_n;
}

Eigen::Vector3d PullingHand::asked_n(const Eigen::Vector3d& position_m) const {
  return force_n_ + stiffness_n_m_ * (hand_m_ - position_m);
}

void PullingHand::pull(const Eigen::Vector3d& force_n, Simulation& simulation) {
  acting_n_ = force_n;
  if (acting_n_.norm() > largest_n_) acting_n_ *= largest_n_ / acting_n_.norm();
  simulation.pull({{*hold_, acting_n_}});
}

// Broyden's method: what a try moved the place by corrects what a force is taken to move it by.
SolveReport PullingHand::step(Simulation& simulation) {
  constexpr double felt_n = 1e-5, accuracy = 0.01;
  constexpr int most_tries = 4;
  if (!hold_ || stiffness_n_m_ == 0.0) return simulation.step();
  const SimulationState before = simulation.state();
  SolveReport report = simulation.step();
  for (int tries = 1; tries < most_tries && !report.interrupted; ++tries) {
    const Eigen::Vector3d position_m = hold_->at(simulation.state().positions_m), force_n = acting_n_;
    const Eigen::Matrix3d stiffer = Eigen::Matrix3d::Identity() + stiffness_n_m_ * yield_m_n_;
    const Eigen::Vector3d wanted_n = stiffer.partialPivLu().solve(asked_n(position_m) - force_n);
    if (!wanted_n.allFinite() || wanted_n.norm() < felt_n + accuracy * force_n.norm()) break;
    simulation.set_state(before);
    pull(force_n + wanted_n, simulation);
    report = simulation.step();
    const Eigen::Vector3d moved_m = hold_->at(simulation.state().positions_m) - position_m,
                          change_n = acting_n_ - force_n;
    if (change_n.norm() > felt_n)
      yield_m_n_ += (moved_m - yield_m_n_ * change_n) * change_n.transpose() / change_n.squaredNorm();
  }
  return report;
}

void PullingHand::let_go(Simulation& simulation) {
  if (hold_) simulation.pull({});
  hold_.reset();
}

void PullingHand::let_go_if_silent(double now_s, Simulation& simulation) {
  if (hold_ && now_s > heard_s_ + silence_s) let_go(simulation);
}

}  // namespace soft_robot_lab
