// SPDX-License-Identifier: BSD-3-Clause
#include "rest_path.h"

#include <algorithm>
#include <cmath>

#include "free_motion.h"
#include "mechanics/contact/fast_obstacles.h"
#include "mechanics/body/gap.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {
namespace {

constexpr double kMostTurn_rad = 0.7853981633974483;  // of a hold in one stage: 45 degrees
constexpr double kMostStageParts = 1e4;               // of a stage
constexpr double kShareMet = 1e-6;                    // of the way: nearer is there

void add_poses(const std::vector<ObstaclePose>& motion, double from_s, double to_s, std::vector<double>& times_s) {
  for (const ObstaclePose& pose : motion)
    if (pose.time_s > from_s && pose.time_s < to_s) times_s.push_back(pose.time_s);
}

double largest_turn_rad(const Body& body, double from_s, double to_s) {
  double largest = 0.0;
  for (const Hold& hold : body.holds()) {
    if (hold.motion.empty()) continue;
    const Eigen::Isometry3d way = way_between(hold.motion, hold.center_m, from_s, to_s);
    largest = std::max(largest, std::abs(Eigen::AngleAxisd(way.linear()).angle()));
  }
  return largest;
}

}  // namespace

RestPath::RestPath(SimulationParts& parts)
    : parts_(parts), commands_(parts.state.actuated_commands()), start_s_(parts.state.contact.time_s) {
  end_s_ = std::max(end_of_motion_s(parts.body.obstacles()), parts.body.end_of_hold_motion_s());
  for (const Obstacle& obstacle : parts.body.obstacles()) add_poses(obstacle.motion, start_s_, end_s_, poses_s_);
  for (const Hold& hold : parts.body.holds()) add_poses(hold.motion, start_s_, end_s_, poses_s_);
  std::sort(poses_s_.begin(), poses_s_.end());
}

bool RestPath::bring_loads_slowly() {
  NewtonSolver& newton = parts_.workspace.newton;
  if (loads_come_slowly() || newton.contact().free().count() > 0) return false;
  if (!free_motion(parts_.body, parts_.state.positions_m, ContactSums()).empty()) return false;
  go_to(0.0);
  if (newton.rest_residual(parts_.unknowns()) <= parts_.options.tolerance) return false;
  left_n_ = newton.residual_n(parts_.unknowns());
  return true;
}

RestPath::~RestPath() {
  if (loads_come_slowly()) parts_.workspace.newton.loads().add(Eigen::Matrix3Xd::Zero(3, left_n_.cols()));
}

void RestPath::go_to(double share) {
  parts_.place_actuators(commands_, parts_.state.commands(), share);
  parts_.state.contact.time_s = time_s(share);
  if (loads_come_slowly()) parts_.workspace.newton.loads().add((1.0 - share) * left_n_);
}

double RestPath::largest_way_m(double from, double to) const {
  const double from_s = time_s(from), to_s = time_s(to);
  Eigen::Matrix3Xd start_m = parts_.body.mesh().nodes_m, end_m = start_m;
  parts_.body.place_held_nodes(from_s, start_m);
  parts_.body.place_held_nodes(to_s, end_m);
  double largest_m = (end_m - start_m).colwise().norm().maxCoeff();
  for (const Obstacle& obstacle : parts_.body.obstacles()) {
    const Eigen::Vector3d at_m = center_m(obstacle.shape);
    largest_m = std::max(largest_m, (pose_at(obstacle, to_s) * at_m - pose_at(obstacle, from_s) * at_m).norm());
  }
  return largest_m;
}

int RestPath::poses_before(double share) const {
  const double met_s = time_s(share) + kShareMet * (end_s_ - start_s_);
  return static_cast<int>(std::upper_bound(poses_s_.begin(), poses_s_.end(), met_s) - poses_s_.begin());
}

double RestPath::stage_end(double from, double to) const {
  if (start_s_ == end_s_) return to;
  const double step = end_s_ - start_s_, from_s = time_s(from);
  for (const double pose_s : poses_s_) {
    const double share = (pose_s - start_s_) / step;
    if (share > from + kShareMet && share < to - kShareMet) to = share;
  }
  const double turn_rad = largest_turn_rad(parts_.body, from_s, time_s(to));
  double parts = std::ceil((1.0 - kShareMet) * turn_rad / kMostTurn_rad);
  const Eigen::Matrix3Xd at_rest = Eigen::Matrix3Xd::Zero(3, parts_.state.positions_m.cols());
  const ContactTerm& contact = parts_.workspace.newton.contact();
  FreeVelocities still;
  still.linear_m_s = still.angular_rad_s = Eigen::Matrix3Xd::Zero(3, contact.free().count());
  ContactState state = parts_.state.contact;
  state.time_s = from_s;
  const ObstacleCuts cuts =
      parts_for_obstacles(parts_.body, contact, parts_.state.positions_m, at_rest, state, still, time_s(to) - from_s);
  parts = std::min(std::max(parts, std::ceil(cuts.parts)), kMostStageParts);
  return parts > 1.0 ? from + (to - from) / parts : to;
}

}  // namespace soft_robot_lab
