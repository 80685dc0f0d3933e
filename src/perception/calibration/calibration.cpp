// SPDX-License-Identifier: BSD-3-Clause
#include "calibration.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "point_matching.h"
#include "rigid_fit.h"

namespace soft_robot_lab {
namespace {

constexpr int min_balls = 5, min_markers = 4;

std::string millimetres(double length_m) {
  std::ostringstream text;
  text.precision(3);
  text << 1000 * length_m << " mm";
  return text.str();
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

Eigen::Matrix3Xd positions(const std::vector<FoundBall>& balls) {
  Eigen::Matrix3Xd points_m(3, static_cast<Eigen::Index>(balls.size()));
  for (std::size_t i = 0; i < balls.size(); ++i) points_m.col(static_cast<Eigen::Index>(i)) = balls[i].center_m;
  return points_m;
}

Eigen::Matrix3Xd positions(const std::vector<PlacedBall>& balls) {
  Eigen::Matrix3Xd points_m(3, static_cast<Eigen::Index>(balls.size()));
  for (std::size_t i = 0; i < balls.size(); ++i) points_m.col(static_cast<Eigen::Index>(i)) = balls[i].position_m;
  return points_m;
}

std::vector<std::string> names(const std::vector<PlacedBall>& balls) {
  std::vector<std::string> all;
  for (const PlacedBall& ball : balls) all.push_back(ball.name);
  return all;
}

// A camera knows no names; its balls are counted from left to right.
std::vector<std::string> names(const BallView& view) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < view.balls.size(); ++i) all.push_back(std::to_string(i + 1));
  return all;
}

std::string order_text(const std::vector<PointMatch>& matches, const std::vector<std::string>& second_names) {
  std::vector<std::string> order;
  for (const PointMatch& match : matches) order.push_back(second_names[static_cast<std::size_t>(match.second)]);
  return "(" + joined(order) + ")";
}

// Second names whose partner differs from one matching to the other.
std::string disputed(const PointMatching& matching, const std::vector<std::string>& second_names) {
  std::vector<std::string> differing;
  for (const PointMatch& match : matching.best)
    if (std::find(matching.rival.begin(), matching.rival.end(), match) == matching.rival.end())
      differing.push_back(second_names[static_cast<std::size_t>(match.second)]);
  return joined(differing);
}

void require_enough(std::size_t count, const std::string& who, int needed, const std::string& things) {
  if (count < static_cast<std::size_t>(needed))
    throw CalibrationError(who + " " + std::to_string(count) + " " + things + "; allowed: " + std::to_string(needed) +
                           " or more");
}

void require_one_way(const PointMatching& matching, const std::string& who,
                     const std::vector<std::string>& second_names, double tolerance_m) {
  if (matching.rival.empty()) return;
  throw CalibrationError(who + " are placed ambiguously: they can be taken for " +
                         order_text(matching.best, second_names) + " and, within " + millimetres(tolerance_m) +
                         ", for " + order_text(matching.rival, second_names) + "; move one of " +
                         disputed(matching, second_names) + " by more than " + millimetres(4 * tolerance_m));
}

PointMatching match_balls(const Eigen::Matrix3Xd& first_m, const Eigen::Matrix3Xd& second_m, double tolerance_m,
                          const std::string& who, const std::vector<std::string>& second_names) {
  PointMatching matching;
  try {
    matching = match_points(first_m, second_m, tolerance_m, min_balls);
  } catch (const std::invalid_argument& error) {
    throw CalibrationError(who + ": " + error.what());
  }
  if (matching.best.empty())
    throw CalibrationError(who + " do not fit: no " + std::to_string(min_balls) +
                           " of them have the distances from each other " + "that they should have, within " +
                           millimetres(2 * tolerance_m));
  require_one_way(matching, who, second_names, tolerance_m);
  return matching;
}

RigidFit fit(const std::vector<PointPair>& pairs, const std::string& who) {
  try {
    return fit_rigid(pairs);
  } catch (const std::invalid_argument& error) {
    throw CalibrationError(who + ": " + error.what());
  }
}

CameraCalibration to_calibration(const std::string& camera, const RigidFit& world_from_camera) {
  CameraCalibration calibration;
  calibration.pose = {camera, world_from_camera.first_from_second, world_from_camera.residual_m};
  calibration.covariance = world_from_camera.covariance;
  return calibration;
}

}  // namespace

void require_unambiguous(const BallPlacement& placement) {
  require_enough(placement.balls.size(), "the placement has", min_balls, "balls");
  const Eigen::Matrix3Xd points_m = positions(placement.balls);
  match_balls(points_m, points_m, placement.tolerance_m, "the placement's balls", names(placement.balls));
  std::vector<PointPair> pairs(placement.balls.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].first_m = pairs[i].second_m = placement.balls[i].position_m;
  fit(pairs, "the placement's balls");
}

BallPlacement read_ball_placement(const std::string& path) {
  const YamlNode file = YamlNode::load_file(path);
  BallPlacement placement;
  placement.radius_m = file.number_or("radius_m", placement.radius_m, AllowedRange::positive());
  placement.position_sigma_m =
      file.number_or("position_sigma_m", placement.position_sigma_m, AllowedRange::not_negative());
  placement.tolerance_m = file.number_or("tolerance_m", placement.tolerance_m, AllowedRange::positive());
  std::set<std::string> known;
  for (const YamlNode& node : file.sequence("balls")) {
    placement.balls.push_back({node.text("name"), node.vector3("position_m")});
    if (!known.insert(placement.balls.back().name).second) node.child("name").fail("is there twice");
  }
  file.require_all_read();
  try {
    require_unambiguous(placement);
  } catch (const CalibrationError& error) {
    file.child("balls").fail(error.what());
  }
  return placement;
}

CameraCalibration calibrate_by_balls(const BallView& view, const BallPlacement& placement) {
  require_enough(view.balls.size(), view.camera + " sees", min_balls, "balls");
  const std::string who = "the balls that " + view.camera + " sees";
  const PointMatching matching = match_balls(positions(view.balls), positions(placement.balls), placement.tolerance_m,
                                             who, names(placement.balls));
  const Eigen::Matrix3d placed_covariance_m2 =
      placement.position_sigma_m * placement.position_sigma_m * Eigen::Matrix3d::Identity();
  std::vector<PointPair> pairs;
  std::vector<std::string> seen;
  for (const PointMatch& match : matching.best) {
    const FoundBall& found = view.balls[static_cast<std::size_t>(match.first)];
    const PlacedBall& placed = placement.balls[static_cast<std::size_t>(match.second)];
    pairs.push_back({placed.position_m, found.center_m, placed_covariance_m2, found.covariance_m2});
    seen.push_back(placed.name);
  }
  CameraCalibration calibration = to_calibration(view.camera, fit(pairs, who));
  calibration.seen = seen;
  return calibration;
}

CameraCalibration calibrate_by_camera(const BallView& view, const BallView& other, const CameraPose& other_pose,
                                      double tolerance_m) {
  for (const BallView* each : {&view, &other})
    require_enough(each->balls.size(), each->camera + " sees", min_balls, "balls");
  const std::string who = "the balls that " + view.camera + " and " + other.camera + " see";
  const PointMatching matching =
      match_balls(positions(view.balls), positions(other.balls), tolerance_m, who, names(other));
  const Eigen::Matrix3d turn = other_pose.world_from_camera.linear();
  std::vector<PointPair> pairs;
  std::vector<std::string> seen;
  for (const PointMatch& match : matching.best) {
    const FoundBall& found = view.balls[static_cast<std::size_t>(match.first)];
    const FoundBall& its = other.balls[static_cast<std::size_t>(match.second)];
    pairs.push_back({other_pose.world_from_camera * its.center_m, found.center_m,
                     turn * its.covariance_m2 * turn.transpose(), found.covariance_m2});
    seen.push_back(other.camera + " " + std::to_string(match.second + 1));
  }
  CameraCalibration calibration = to_calibration(view.camera, fit(pairs, who));
  calibration.seen = seen;
  return calibration;
}

CameraCalibration calibrate_by_markers(const std::string& camera, const std::vector<CalibrationMarker>& markers,
                                       double tolerance_m) {
  require_enough(markers.size(), camera + " sees", min_markers, "markers");
  std::vector<PointPair> pairs;
  std::vector<std::string> seen;
  for (const CalibrationMarker& marker : markers) {
    pairs.push_back({marker.expected_m, marker.in_camera_m, Eigen::Matrix3d::Zero(), marker.covariance_m2});
    seen.push_back(marker.name);
  }
  const RigidFit world_from_camera = fit(pairs, "the markers that " + camera + " sees");
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double miss_m = (pairs[i].first_m - world_from_camera.first_from_second * pairs[i].second_m).norm();
    if (miss_m > tolerance_m)
      throw CalibrationError(camera + " sees marker " + seen[i] + " " + millimetres(miss_m) +
                             " from where it is expected; allowed: " + millimetres(tolerance_m) +
                             ". Is the robot at rest, and the marker the right one?");
  }
  CameraCalibration calibration = to_calibration(camera, world_from_camera);
  calibration.seen = seen;
  return calibration;
}

}  // namespace soft_robot_lab
