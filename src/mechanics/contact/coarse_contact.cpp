// SPDX-License-Identifier: BSD-3-Clause
#include "coarse_contact.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <variant>

#include "mechanics/body/gap.h"
#include "mechanics/mesh/shape_functions.h"
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

// `why`, and how large elements should be there.
SolveWarning about(const Obstacle& obstacle, double size, const std::string& unit, const std::string& why,
                   double element_size_m) {
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

SolveWarning warning_of(const Obstacle& obstacle, const Deepest& deepest) {
  std::ostringstream why;
  why << "is too small or too sharp for the contact points that meet it: it is " << deepest.depth_m
      << " m deep in the skin between them, at " << point_text(deepest.at_m);
  return about(obstacle, deepest.depth_m, "m", why.str(),
               std::min(size_m(obstacle.shape), kFiner * deepest.face_size_m));
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
  return about(obstacle, patch.face_m2 / patch.area_m2, "1", why.str(), std::sqrt(patch.area_m2));
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

std::vector<SolveWarning> coarse_contacts(const Body& body, const ContactTerm& contact,
                                          const Eigen::Matrix3Xd& positions_m, const ContactState& state) {
  std::vector<SolveWarning> warnings;
  const ContactPoints& points = contact.points();
  if (points.count() == 0) return warnings;
  warn_of_rolling(body, contact, positions_m, state, warnings);
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
    if (deepest.depth_m > kSeenDepth * size_m(obstacle.shape)) warnings.push_back(warning_of(obstacle, deepest));
  }
  return warnings;
}

}  // namespace soft_robot_lab
