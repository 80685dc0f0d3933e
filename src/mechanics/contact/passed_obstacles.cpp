// SPDX-License-Identifier: BSD-3-Clause
#include "passed_obstacles.h"

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <variant>

#include "coarse_contact.h"
#include "mechanics/body/free_obstacles.h"
#include "mechanics/body/gap.h"
#include "mechanics/mesh/shape_functions.h"
#include "present_faces.h"
#include "settings/point_text.h"
#include "swept_obstacles.h"

namespace soft_robot_lab {
namespace {

constexpr double kUnseen = 0.5;   // of a face: an obstacle of less half least extent is small
constexpr double kPassed = 0.5;   // of an obstacle's half least extent: a depth that is a passage
constexpr double kBow = 0.25;     // of a way: how far a bent one may be from a straight one, at a turn of 1.8 rad
constexpr double kFine = 0.35;    // of an obstacle's half least extent: a part of a face that its middle stands for,
constexpr double kFinest = 0.1;   // and where it may be grazed
constexpr double kNear = 0.05;    // likewise: of conservative advancement
constexpr double kBulge = 1.25;   // times its corners' distance from its middle: how far a part of a face reaches
constexpr int kFinestParts = 16;  // times that a face is halved: smaller ones are no obstacles

// A face on its straight way, beside an obstacle that stands as its shape says.
class FaceWay {
 public:
  // `grazes`: also where only a bent way would lead into it.
  FaceWay(const ObstacleShape& shape, bool grazes, FaceNodes from_m, const FaceNodes& to_m)
      : shape_(shape), size_m_(size_m(shape)), grazes_(grazes), from_m_(std::move(from_m)), way_m_(to_m - from_m_) {
    if (grazes_) deep_m_ = -kBow * way_m_.colwise().norm().maxCoeff();
    fine_m_ = grazes_ ? std::max(kFinest * size_m_, -0.5 * deep_m_) : kFine * size_m_;
  }

  // A place of the skin where it goes through the obstacle, but for where it was before.
  std::optional<Eigen::Vector3d> passage_m() const {
    return passage_in({{Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1)}}, 0);
  }

 private:
  using Corners = std::array<Eigen::Vector2d, 3>;  // (r, s) of a part of the face

  struct Point {
    Eigen::Vector3d from_m, way_m;
  };
  Point at(const Eigen::Vector2d& place) const {
    const auto values = face_shape(from_m_.cols(), place[0], place[1]).values;
    return {from_m_ * values, way_m_ * values};
  }

  std::optional<double> until(const Point& point, double depth_m) const {
    if (point.way_m.squaredNorm() == 0.0) return std::nullopt;
    const double part =
        part_until(shape_, Eigen::Isometry3d::Identity(), point.from_m, point.way_m, depth_m, kNear * size_m_);
    return part < 1.0 ? std::optional(part) : std::nullopt;
  }

  std::optional<Eigen::Vector3d> passage_in(const Corners& corners, int depth) const;

  const ObstacleShape& shape_;
  double size_m_, deep_m_ = kPassed * size_m_, fine_m_ = 0.0;
  bool grazes_;
  FaceNodes from_m_, way_m_;
};

// What a part reaches at either end of the way it reaches nowhere more on it.
std::optional<Eigen::Vector3d> FaceWay::passage_in(const Corners& corners, int depth) const {
  const Point middle = at((corners[0] + corners[1] + corners[2]) / 3.0);
  double reach_m = 0.0;
  for (const Eigen::Vector2d& corner : corners) {
    const Point point = at(corner);
    const Eigen::Vector3d beside_m = point.from_m - middle.from_m;
    reach_m = std::max({reach_m, beside_m.norm(), (beside_m + point.way_m - middle.way_m).norm()});
  }
  if (!until(middle, std::min(deep_m_, 0.0) - kBulge * reach_m)) return std::nullopt;
  if (reach_m <= fine_m_ || depth == kFinestParts) {
    const bool was_deep = !grazes_ && gap_to(shape_, middle.from_m).gap_m <= -deep_m_;
    const std::optional<double> part = was_deep ? std::nullopt : until(middle, deep_m_);
    if (!part) return std::nullopt;
    return Eigen::Vector3d(middle.from_m + *part * middle.way_m);
  }
  const Eigen::Vector2d a = 0.5 * (corners[1] + corners[2]), b = 0.5 * (corners[2] + corners[0]),
                        c = 0.5 * (corners[0] + corners[1]);
  for (const Corners& part :
       {Corners{corners[0], c, b}, Corners{c, corners[1], a}, Corners{b, a, corners[2]}, Corners{a, b, c}})
    if (const auto found_m = passage_in(part, depth + 1)) return found_m;
  return std::nullopt;
}

// As an obstacle sees it that stands as its shape says.
FaceNodes beside(const Eigen::Isometry3d& pose, const FaceNodes& face_m) {
  return (pose.inverse().linear() * face_m).colwise() + pose.inverse().translation();
}

// A ball around all places of the skin on its way.
struct AroundWay {
  Eigen::Vector3d middle_m;
  double radius_m;

  AroundWay(const Eigen::Matrix3Xd& from_m, const Eigen::Matrix3Xd& to_m) {
    const Eigen::Vector3d low_m = from_m.rowwise().minCoeff().cwiseMin(to_m.rowwise().minCoeff()),
                          high_m = from_m.rowwise().maxCoeff().cwiseMax(to_m.rowwise().maxCoeff());
    middle_m = 0.5 * (low_m + high_m);
    radius_m = 0.5 * (high_m - low_m).norm();
  }

  bool is_far_from(const ObstacleShape& shape, const Eigen::Isometry3d& start, const Eigen::Isometry3d& end) const {
    const double way_m = (end * center_m(shape) - start * center_m(shape)).norm();
    const double reach_m = radius_m + way_m + kBow * (2.0 * radius_m + way_m);
    return gap_to(shape, start, middle_m).gap_m > reach_m && gap_to(shape, end, middle_m).gap_m > reach_m;
  }
};

bool touched(const ContactTerm& contact, std::size_t obstacle, const ContactState& state) {
  const Eigen::Index points = contact.points().count();
  return (state.pressures_pa.segment(static_cast<Eigen::Index>(obstacle) * points, points).array() > 0.0).any();
}

SolveWarning warning_of(const Obstacle& obstacle, double face_size_m, const Eigen::Vector3d& at_m) {
  std::ostringstream why;
  why << "went through the skin between its contact points, at " << point_text(at_m);
  const double size = size_m(obstacle.shape);
  return coarse_contact_warning(obstacle, size, "m", why.str(), std::min(size, kUnseen * face_size_m));
}

}  // namespace

bool has_small_obstacles(const Body& body, const ContactTerm& contact) {
  if (contact.points().count() == 0) return false;
  return std::any_of(body.obstacles().begin(), body.obstacles().end(), [&](const Obstacle& obstacle) {
    return !std::holds_alternative<Plane>(obstacle.shape) &&
           size_m(obstacle.shape) < kUnseen * contact.points().largest_face_size_m();
  });
}

std::vector<SolveWarning> passed_obstacles(const Body& body, const ContactTerm& contact, const BodyPlace& from,
                                           const BodyPlace& to, PassedSizes sizes) {
  std::vector<SolveWarning> warnings;
  const ContactPoints& points = contact.points();
  if (points.count() == 0 || body.obstacles().empty()) return warnings;
  const AroundWay around(from.positions_m, to.positions_m);
  for (std::size_t i = 0; i < body.obstacles().size(); ++i) {
    const Obstacle& obstacle = body.obstacles()[i];
    if (std::holds_alternative<Plane>(obstacle.shape)) continue;
    const Eigen::Isometry3d start = contact.pose_of(static_cast<int>(i), from.contact),
                            end = contact.pose_of(static_cast<int>(i), to.contact);
    if (around.is_far_from(obstacle.shape, start, end)) continue;
    const bool grazes =
        sizes == PassedSizes::any && !touched(contact, i, from.contact) && !touched(contact, i, to.contact);
    for (int face = 0; face < points.face_count(); ++face) {
      const double face_size_m = points.face_size_m(points.first_point(face));
      if (sizes == PassedSizes::small && size_m(obstacle.shape) >= kUnseen * face_size_m) continue;
      const FaceWay way(obstacle.shape, grazes, beside(start, nodes_of(points.faces(), face, from.positions_m)),
                        beside(end, nodes_of(points.faces(), face, to.positions_m)));
      if (const auto at_m = way.passage_m()) {
        warnings.push_back(warning_of(obstacle, face_size_m, end * *at_m));
        break;
      }
    }
  }
  return warnings;
}

}  // namespace soft_robot_lab
