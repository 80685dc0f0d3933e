// SPDX-License-Identifier: BSD-3-Clause
#include "coarse_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <variant>

#include <Eigen/Geometry>

#include "mechanics/body/gap.h"
#include "mechanics/mesh/shape_functions.h"
#include "mechanics/mesh/solid_angle.h"
#include "present_faces.h"
#include "settings/point_text.h"

namespace soft_robot_lab {
namespace {

constexpr double kSeenDepth = 0.05;                 // of an obstacle's half least extent: a depth that counts
constexpr double kFiner = 0.5;                      // of a face: one that sees more
constexpr int kCoarsestGrid = 4, kFinestGrid = 24;  // of a face's edge, that are looked at

struct Deepest {
  double depth_m = 0.0;
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
  double face_size_m = 0.0;
};

// Along an even grid over a face, of these nodes.
void look_between_points(const ObstacleShape& shape, const Eigen::Isometry3d& pose, const FaceNodes& face_m,
                         double face_size_m, Deepest& deepest) {
  const int parts =
      std::clamp(static_cast<int>(std::ceil(2.0 * face_size_m / size_m(shape))), kCoarsestGrid, kFinestGrid);
  for (int i = 0; i <= parts; ++i) {
    for (int j = 0; i + j <= parts; ++j) {
      const Eigen::Vector3d at_m =
          face_m * face_shape(face_m.cols(), static_cast<double>(i) / parts, static_cast<double>(j) / parts).values;
      const double depth_m = -gap_to(shape, pose, at_m).gap_m;
      if (depth_m > deepest.depth_m) deepest = {depth_m, at_m, face_size_m};
    }
  }
}

SolveWarning warning_of(const Obstacle& obstacle, const Deepest& deepest) {
  std::ostringstream why;
  why << "is too small or too sharp for the contact points that meet it: it is " << deepest.depth_m
      << " m deep in the skin between them, at " << point_text(deepest.at_m);
  return coarse_contact_warning(obstacle, deepest.depth_m, "m", why.str(),
                                std::min(size_m(obstacle.shape), kFiner * deepest.face_size_m));
}

// Whether the body's faces surround a place, by their corners.
bool in_silicone(const Eigen::MatrixXi& faces, const Eigen::Matrix3Xd& positions_m, const Eigen::Vector3d& at_m) {
  double half = 0.0;
  for (Eigen::Index face = 0; face < faces.cols(); ++face) {
    const auto corner_m = [&](int corner) -> Eigen::Vector3d { return positions_m.col(faces(corner, face)) - at_m; };
    half += half_solid_angle(corner_m(0), corner_m(1), corner_m(2));
  }
  return std::abs(half) > M_PI;
}

// Of an obstacle that no face meets: how deep its middle is in the silicone; 0: it is not, or the obstacle has a hole
// there.
double swallowed_m(const Obstacle& obstacle, const Eigen::Isometry3d& pose, const Eigen::Vector3d& middle_m,
                   const Body& body, const Eigen::Matrix3Xd& positions_m) {
  if (gap_to(obstacle.shape, pose, middle_m).gap_m >= 0.0) return 0.0;
  if (!in_silicone(body.mesh().faces, positions_m, middle_m)) return 0.0;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (Eigen::Index face = 0; face < body.mesh().faces.cols(); ++face)
    for (int corner = 0; corner < 3; ++corner)
      nearest_m = std::min(nearest_m, (positions_m.col(body.mesh().faces(corner, face)) - middle_m).norm());
  return nearest_m;
}

SolveWarning warning_of_swallowed(const Obstacle& obstacle, double depth_m, const Eigen::Vector3d& middle_m) {
  std::ostringstream why;
  why << "is in the silicone, at " << point_text(middle_m)
      << ", as it is too small for the contact points, or the body "
      << "went too far at once";
  return coarse_contact_warning(obstacle, depth_m, "m", why.str(), size_m(obstacle.shape));
}

// Pressed skin of an obstacle.
struct Patch {
  double area_m2 = 0.0, face_m2 = 0.0;  // of the largest face in it
  bool round = false;
  Eigen::Vector3d at_m = Eigen::Vector3d::Zero();
};

SolveWarning warning_of(const Obstacle& obstacle, const Patch& patch) {
  std::ostringstream why;
  why << "presses round skin over " << patch.area_m2 << " m^2, less than one of its faces, at "
      << point_text(patch.at_m) << ": rolling is braked";
  return coarse_contact_warning(obstacle, patch.face_m2 / patch.area_m2, "1", why.str(), std::sqrt(patch.area_m2));
}

// A body that nothing holds rolls on what it touches, from one contact point to the next where these are far apart.
void warn_of_rolling(const Body& body, const ContactTerm& contact, const Eigen::Matrix3Xd& positions_m,
                     const ContactState& state, std::vector<SolveWarning>& warnings) {
  if (body.fixed().any()) return;
  const ContactPoints& points = contact.points();
  std::vector<Patch> patches(body.obstacles().size());
  for (const ContactTouch& touch : contact.sums(positions_m, state).touches) {
    if (touch.on_skin() || touch.pressure_pa == 0.0 || !touch.rubs()) continue;
    const int point = touch.pair % points.count();
    Patch& patch = patches[static_cast<std::size_t>(touch.pair / points.count())];
    patch.area_m2 += points.present_area_m2(point, positions_m);
    patch.face_m2 = std::max(patch.face_m2, 0.5 * std::pow(points.face_size_m(point), 2));
    patch.round = patch.round || points.is_round(point);
    patch.at_m = points.at(point, positions_m);
  }
  for (std::size_t i = 0; i < patches.size(); ++i)
    if (patches[i].round && patches[i].area_m2 < patches[i].face_m2)
      warnings.push_back(warning_of(body.obstacles()[i], patches[i]));
}

}  // namespace

SolveWarning coarse_contact_warning(const Obstacle& obstacle, double size, const std::string& unit,
                                    const std::string& why, double element_size_m) {
  SolveWarning warning;
  warning.kind = "coarse_contact";
  warning.actuator = obstacle.name;
  warning.size = size;
  warning.unit = unit;
  std::ostringstream text;
  text << "obstacle '" << obstacle.name << "' " << why << "; elements there of " << element_size_m
       << " m (body.refinements, or body.element_size_m) would do";
  warning.text = text.str();
  return warning;
}

std::vector<SolveWarning> coarse_contacts(const Body& body, const ContactTerm& contact,
                                          const Eigen::Matrix3Xd& positions_m, const ContactState& state) {
  std::vector<SolveWarning> warnings;
  const ContactPoints& points = contact.points();
  if (points.count() == 0) return warnings;
  warn_of_rolling(body, contact, positions_m, state, warnings);
  const Eigen::AlignedBox3d around(positions_m.rowwise().minCoeff(), positions_m.rowwise().maxCoeff());
  for (std::size_t i = 0; i < body.obstacles().size(); ++i) {
    const Obstacle& obstacle = body.obstacles()[i];
    if (std::holds_alternative<Plane>(obstacle.shape)) continue;
    const Eigen::Isometry3d pose = contact.pose_of(static_cast<int>(i), state);
    Deepest deepest;
    for (int face = 0; face < points.face_count(); ++face) {
      const FaceNodes face_m = nodes_of(points.faces(), face, positions_m);
      const Eigen::Vector3d middle_m = face_m.rowwise().mean();
      const double reach_m = (face_m.colwise() - middle_m).colwise().norm().maxCoeff();
      if (gap_to(obstacle.shape, pose, middle_m).gap_m > reach_m) continue;
      look_between_points(obstacle.shape, pose, face_m, points.face_size_m(points.first_point(face)), deepest);
    }
    if (deepest.depth_m > kSeenDepth * size_m(obstacle.shape)) {
      warnings.push_back(warning_of(obstacle, deepest));
      continue;
    }
    const Eigen::Vector3d middle_m = pose * center_m(obstacle.shape);
    if (!around.contains(middle_m)) continue;
    const double depth_m = swallowed_m(obstacle, pose, middle_m, body, positions_m);
    if (depth_m > 0.0) warnings.push_back(warning_of_swallowed(obstacle, depth_m, middle_m));
  }
  return warnings;
}

}  // namespace soft_robot_lab
