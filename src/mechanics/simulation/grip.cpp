// SPDX-License-Identifier: BSD-3-Clause
#include "grip.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "mechanics/body/gap.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {
namespace {

constexpr double kAlike = 1e-9;    // of a pose, or a way
constexpr double kTogether = 0.2;  // of a way: what differs by less carries a thing along

// How the holds of a body move, where they move alike; `held` says whether it has any.
std::optional<Eigen::Isometry3d> way_of_holds(const Body& body, int one, double from_s, double to_s, bool& held) {
  std::optional<Eigen::Isometry3d> way;
  for (const Hold& hold : body.holds()) {
    const bool of_it =
        std::any_of(hold.nodes.begin(), hold.nodes.end(), [&](int node) { return body.body_of_node(node) == one; });
    if (!of_it) continue;
    held = true;
    const Eigen::Isometry3d its = way_between(hold.motion, hold.center_m, from_s, to_s);
    if (way && !its.isApprox(*way, kAlike)) return std::nullopt;
    way = its;
  }
  return way;
}

// Half the least extent of a body's rest shape.
double size_m(const Body& body, int one) {
  Eigen::AlignedBox3d box;
  for (int node = 0; node < static_cast<int>(body.mesh().nodes_m.cols()); ++node)
    if (body.body_of_node(node) == one) box.extend(Eigen::Vector3d(body.mesh().nodes_m.col(node)));
  return 0.5 * box.sizes().minCoeff();
}

}  // namespace

Grip::Grip(const SimulationParts& parts, double from_s, double to_s)
    : parts_(parts), contact_(parts.workspace.newton.contact()) {
  if (contact_.empty()) return;
  find_things(from_s, to_s);
  if (!has_loose_things()) return;
  start_m_ = parts.state.positions_m;
  start_contact_ = parts.state.contact;
  add_skin_touches(from_s, to_s);
  add_rigid_touches(from_s, to_s);
  find_ways();
}

void Grip::find_things(double from_s, double to_s) {
  for (int free = 0; free < contact_.free().count(); ++free)
    things_.push_back({true, contact_.free().size_m(free), std::nullopt});
  for (int body = 0; body < static_cast<int>(parts_.body.mesh().bodies.size()); ++body) {
    bool held = false;
    const Way way = way_of_holds(parts_.body, body, from_s, to_s, held);
    things_.push_back({!held, held ? 0.0 : size_m(parts_.body, body), way});
  }
}

Grip::Way Grip::way_of_obstacle(int obstacle, double from_s, double to_s) const {
  const Obstacle& one = parts_.body.obstacles()[static_cast<std::size_t>(obstacle)];
  const Eigen::Isometry3d way = way_between(one.motion, center_m(one.shape), from_s, to_s);
  return way.isApprox(Eigen::Isometry3d::Identity(), kAlike) ? Way() : Way(way);
}

// What stands still counts as little as what is held on both sides.
void Grip::add(Rub rub) {
  if (!thing(rub.thing).loose && rub.other >= 0) std::swap(rub.thing, rub.other);
  if (!thing(rub.thing).loose || (rub.other < 0 && !rub.way)) return;
  rubs_.push_back(std::move(rub));
}

void Grip::add_skin_touches(double from_s, double to_s) {
  const ContactSums at = contact_.sums(start_m_, start_contact_);
  const int frees = contact_.free().count();
  for (const ContactTouch& touch : at.touches) {
    if (!touch.rubs() || touch.pressure_pa <= 0.0) continue;
    std::array<int, 12> nodes;
    std::array<double, 12> shares;
    const int count = contact_.nodes_of(touch, nodes, shares);
    Rub rub;
    rub.thing = frees + parts_.body.body_of_node(nodes[0]);
    rub.force_n = contact_.weight_m2(touch.pair) * touch.pressure_pa;
    rub.normal = touch.normal;
    rub.touch = touch;
    if (touch.on_skin()) {
      rub.other = frees + parts_.body.body_of_node(nodes[static_cast<std::size_t>(count) - 1]);
      if (rub.other == rub.thing) continue;
      rub.position_m = contact_.skin().points().at(contact_.point_of(touch.pair), start_m_);
    } else {
      const int obstacle = touch.pair / contact_.points().count();
      rub.position_m = at.points_m.col(contact_.point_of(touch.pair));
      rub.two = {obstacle, contact_.pose_of(obstacle, start_contact_).inverse() * rub.position_m};
      if (touch.free >= 0)
        rub.other = touch.free;
      else
        rub.way = way_of_obstacle(obstacle, from_s, to_s);
    }
    add(std::move(rub));
  }
}

void Grip::add_rigid_touches(double from_s, double to_s) {
  const RigidContact& rigid = contact_.rigid();
  for (const RigidTouch& touch : rigid.touches(start_contact_)) {
    if (!touch.rubs() || touch.force_n <= 0.0) continue;
    Rub rub;
    rub.thing = rigid.free_of(touch.pair);
    rub.other = rigid.other_free_of(touch.pair);
    rub.force_n = touch.force_n;
    rub.position_m = touch.position_m;
    rub.normal = touch.normal;
    rub.one = {contact_.free().obstacle(rub.thing), touch.pose.inverse() * touch.position_m};
    rub.two = {rigid.other_of(touch.pair), touch.other_pose.inverse() * touch.position_m};
    if (rub.other < 0) rub.way = way_of_obstacle(rub.two.obstacle, from_s, to_s);
    add(std::move(rub));
  }
}

// How the other side of a place goes where that rubs on the thing; none where it does not, or that is not known.
Grip::Way Grip::way_of_other(const Rub& rub, int of) const {
  if (rub.thing == of) return rub.other >= 0 ? thing(rub.other).way : rub.way;
  return rub.other == of ? thing(rub.thing).way : Way();
}

// By what rubs on it, and moves as is known.
Grip::Way Grip::mean_way(int of) const {
  double force_n = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero(), way_m = position_m, turn = position_m;
  for (const Rub& rub : rubs_) {
    const Way way = way_of_other(rub, of);
    if (!way) continue;
    force_n += rub.force_n;
    position_m += rub.force_n * rub.position_m;
    way_m += rub.force_n * (*way * rub.position_m - rub.position_m);
    turn += rub.force_n * turn_rad(*way);
  }
  if (force_n == 0.0) return std::nullopt;
  return moved_about(position_m / force_n, way_m / force_n, turn / force_n);
}

bool Grip::all_go(int of, const Eigen::Isometry3d& mean, double differing) const {
  return std::all_of(rubs_.begin(), rubs_.end(), [&](const Rub& rub) {
    if (rub.thing != of || (rub.other >= 0 && thing(rub.other).loose)) return true;
    const Way way = way_of_other(rub, of);
    const Eigen::Vector3d went_m = mean * rub.position_m - rub.position_m;
    return way && (*way * rub.position_m - rub.position_m - went_m).norm() <= differing * went_m.norm();
  });
}

// Of what moving things hold, then of what lies on that, and so on.
void Grip::find_ways() {
  for (bool found = true; found;) {
    found = false;
    std::vector<Thing> next = things_;
    for (int i = 0; i < static_cast<int>(things_.size()); ++i) {
      if (!thing(i).loose || thing(i).way || !thing(i).alike) continue;
      const Way way = mean_way(i);
      if (!way) continue;
      Thing& one = next[static_cast<std::size_t>(i)];
      one.alike = all_go(i, *way, kAlike);
      if (!all_go(i, *way, kTogether)) continue;
      one.way = way;
      found = true;
    }
    things_ = std::move(next);
  }
  for (const Rub& rub : rubs_) {
    note_way(rub.thing, rub.position_m);
    if (rub.other >= 0) note_way(rub.other, rub.position_m);
  }
}

void Grip::note_way(int of, const Eigen::Vector3d& position_m) {
  Thing& one = thing(of);
  if (!one.loose || !one.way) return;
  const double way_m = (*one.way * position_m - position_m).norm();
  if (way_m > kAlike * one.size_m) one.way_m = std::max(one.way_m, way_m);
}

bool Grip::moves_alike() const {
  return std::all_of(rubs_.begin(), rubs_.end(), [&](const Rub& rub) { return thing(rub.thing).alike; });
}

bool Grip::has_loose_things() const {
  return std::any_of(things_.begin(), things_.end(), [](const Thing& one) { return one.loose; });
}

bool Grip::rubs_more_than(const Grip& before) const {
  return std::any_of(rubs_.begin(), rubs_.end(), [&](const Rub& rub) {
    return std::none_of(before.rubs_.begin(), before.rubs_.end(),
                        [&](const Rub& other) { return sides(other) == sides(rub); });
  });
}

bool Grip::carries() const {
  return std::any_of(things_.begin(), things_.end(), [](const Thing& one) { return one.loose && one.way_m > 0.0; });
}

bool Grip::goes_a_short_way() const {
  return std::none_of(things_.begin(), things_.end(),
                      [](const Thing& one) { return one.loose && one.way_m > kShort * one.size_m; });
}

void Grip::carry(SimulationState& state) const {
  const int frees = contact_.free().count();
  FreePoses& poses = state.contact.free;
  for (int free = 0; free < frees; ++free) {
    const Way& way = thing(free).way;
    if (!way) continue;
    poses.centers_m.col(free) = *way * Eigen::Vector3d(poses.centers_m.col(free));
    poses.turns.col(free) = (Eigen::Quaterniond(way->linear()) * Eigen::Quaterniond(poses.turns.col(free))).coeffs();
  }
  for (Eigen::Index node = 0; node < state.positions_m.cols(); ++node) {
    const Way& way = thing(frees + parts_.body.body_of_node(static_cast<int>(node))).way;
    if (way) state.positions_m.col(node) = *way * Eigen::Vector3d(state.positions_m.col(node));
  }
}

Eigen::Vector3d Grip::slip_m(const Rub& rub, const SimulationState& to) const {
  const auto there_m = [&](const Side& side) {
    return side.obstacle >= 0 ? Eigen::Vector3d(contact_.pose_of(side.obstacle, to.contact) * side.local_m)
                              : contact_.points().at(contact_.point_of(rub.touch.pair), to.positions_m);
  };
  if (rub.touch.on_skin()) return contact_.relative_motion_m(rub.touch, to.positions_m - start_m_, FreeColumns());
  return there_m(rub.one) - there_m(rub.two);
}

std::vector<Grip::Slipped> Grip::slips(const SimulationState& to) const {
  std::map<Sides, Slipped> of_pairs;
  for (const Rub& rub : rubs_) {
    const Eigen::Vector3d way_m = slip_m(rub, to);
    Slipped& slipped = of_pairs[sides(rub)];
    slipped.thing = rub.thing;
    slipped.mean_m += rub.force_n * (way_m - rub.normal * rub.normal.dot(way_m)).norm();
    slipped.force_n += rub.force_n;
  }
  std::vector<Slipped> all;
  for (const auto& [sides, slipped] : of_pairs)
    all.push_back({slipped.thing, slipped.mean_m / slipped.force_n, slipped.force_n});
  return all;
}

bool Grip::took_along(const SimulationState& to) const {
  const std::vector<Slipped> all = slips(to);
  return std::all_of(all.begin(), all.end(), [&](const Slipped& one) {
    const double way_m = thing(one.thing).way_m;
    return way_m == 0.0 || one.mean_m <= 0.5 * way_m;
  });
}

double Grip::least_size_m() const {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Thing& one : things_)
    if (one.loose) least_m = std::min(least_m, one.size_m);
  return least_m;
}

double Grip::slip(const SimulationState& to) const {
  double largest = 0.0;
  for (const Slipped& one : slips(to)) largest = std::max(largest, one.mean_m / thing(one.thing).size_m);
  return largest;
}

}  // namespace soft_robot_lab
