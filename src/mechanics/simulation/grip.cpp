// SPDX-License-Identifier: BSD-3-Clause
#include "grip.h"

#include <algorithm>
#include <set>

#include "mechanics/body/gap.h"
#include "soft_robot_lab/mechanics/body.h"

namespace soft_robot_lab {
namespace {

constexpr double kAlike = 1e-9;     // of a pose
constexpr double kShortWay = 0.05;  // of what is gripped: half its least extent

// How all holds move, where they move and all alike.
std::optional<Eigen::Isometry3d> way_of_holds(const Body& body, double from_s, double to_s) {
  std::optional<Eigen::Isometry3d> way;
  for (const Hold& hold : body.holds()) {
    const Eigen::Isometry3d one =
        pose_at(hold.motion, hold.center_m, to_s) * pose_at(hold.motion, hold.center_m, from_s).inverse();
    if (way && !one.isApprox(*way, kAlike)) return std::nullopt;
    way = one;
  }
  if (way && way->isApprox(Eigen::Isometry3d::Identity(), kAlike)) return std::nullopt;
  return way;
}

}  // namespace

Grip::Grip(const SimulationParts& parts, double from_s, double to_s)
    : free_(parts.workspace.newton.contact().free()), start_(parts.state.contact.free) {
  if (free_.count() == 0) return;
  way_ = way_of_holds(parts.body, from_s, to_s);
  if (!way_) return;
  std::set<int> gripped;
  for (const ContactTouch& touch :
       parts.workspace.newton.contact().sums(parts.state.positions_m, parts.state.contact).touches)
    if (touch.free >= 0 && touch.rubs() && touch.pressure_pa > 0.0) gripped.insert(touch.free);
  gripped_.assign(gripped.begin(), gripped.end());
}

Eigen::Vector3d Grip::way_m(int free) const { return *way_ * start_.centers_m.col(free) - start_.centers_m.col(free); }

bool Grip::goes_a_short_way() const {
  return std::all_of(gripped_.begin(), gripped_.end(),
                     [&](int free) { return way_m(free).norm() <= kShortWay * free_.size_m(free); });
}

void Grip::carry(SimulationState& state) const {
  FreePoses& poses = state.contact.free;
  for (const int free : gripped_) {
    poses.centers_m.col(free) += way_m(free);
    poses.turns.col(free) = (Eigen::Quaterniond(way_->linear()) * Eigen::Quaterniond(start_.turns.col(free))).coeffs();
  }
  state.positions_m = *way_ * state.positions_m;
}

bool Grip::took_along(const FreePoses& to) const {
  return std::all_of(gripped_.begin(), gripped_.end(), [&](int free) {
    const Eigen::Vector3d went_m = to.centers_m.col(free) - start_.centers_m.col(free);
    return went_m.dot(way_m(free)) >= 0.5 * way_m(free).squaredNorm();
  });
}

}  // namespace soft_robot_lab
