// SPDX-License-Identifier: BSD-3-Clause
#include "pulling_hand.h"

#include <sstream>
#include <stdexcept>

#include "conversions.h"
#include "mechanics/mesh/skin.h"

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

void PullingHand::take(const SkinPull& pull, const Eigen::Vector3d& point_m, double now_s, Simulation& simulation) {
  Eigen::Vector3d force_n = from_message(pull.force, "force");
  if (force_n.isZero(0.0)) return let_go(simulation);
  if (!hold_) hold_ = hold_at(point_m, simulation);
  if (force_n.norm() > largest_n_) force_n *= largest_n_ / force_n.norm();
  simulation.pull(*hold_, force_n);
  heard_s_ = now_s;
}

void PullingHand::let_go(Simulation& simulation) {
  if (hold_) simulation.pull(*hold_, Eigen::Vector3d::Zero());
  hold_.reset();
}

void PullingHand::let_go_if_silent(double now_s, Simulation& simulation) {
  if (hold_ && now_s > heard_s_ + silence_s) let_go(simulation);
}

}  // namespace soft_robot_lab
