// SPDX-License-Identifier: BSD-3-Clause
#include "load_messages.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <Eigen/Eigenvalues>

#include "conversions.h"
#include "frames.h"

namespace soft_robot_lab {
namespace {

constexpr double kShownPush_n = 0.1;  // whose arrow is kShownLength of the robot long
constexpr double kShownLength = 0.35;

// Kinds have the same order as the message's.
static_assert(static_cast<int>(LoadKind::none) == TwinLoads::NONE &&
              static_cast<int>(LoadKind::push) == TwinLoads::PUSH &&
              static_cast<int>(LoadKind::two_pushes) == TwinLoads::TWO_PUSHES &&
              static_cast<int>(LoadKind::weight) == TwinLoads::WEIGHT &&
              static_cast<int>(LoadKind::modulus) == TwinLoads::MODULUS &&
              static_cast<int>(LoadKind::command) == TwinLoads::COMMAND &&
              static_cast<int>(LoadKind::frame) == TwinLoads::FRAME &&
              static_cast<int>(LoadKind::unknown) == TwinLoads::UNKNOWN);

void add(const Eigen::Matrix3d& matrix, std::vector<double>& numbers) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) numbers.push_back(matrix(row, column));
}

double deviation(const Eigen::Matrix3d& covariance) { return std::sqrt(std::max(0.0, covariance.trace())); }

std::string words(const EstimatedLoad& load) {
  std::ostringstream text;
  text.precision(2);
  text << 1e3 * load.force_n.norm() << " mN +-" << 1e3 * deviation(load.force_covariance_n2);
  text.precision(0);
  text << std::fixed;
  if (!load.marker.empty()) return text.str() + " at " + load.marker;
  const Eigen::Vector3d at_mm = 1e3 * load.position_m;
  text << " at (" << at_mm.x() << ", " << at_mm.y() << ", " << at_mm.z() << ") mm";
  if (load.observable)
    return text.str() + ", +-" + std::to_string(std::lround(1e3 * deviation(load.position_covariance_m2)));
  return text.str() + ", or elsewhere";
}

visualization_msgs::Marker marker_of(int type, int id, const ros::Time& stamp) {
  visualization_msgs::Marker marker;
  marker.header.frame_id = robot_frame();
  marker.header.stamp = stamp;
  marker.ns = "loads";
  marker.id = id;
  marker.type = type;
  marker.pose.orientation.w = 1.0;
  marker.color.r = 0.75f;
  marker.color.g = 0.20f;
  marker.color.b = 0.85f;
  marker.color.a = 1.0f;
  return marker;
}

visualization_msgs::Marker arrow_of(const EstimatedLoad& load, double size_m, int id, const ros::Time& stamp) {
  visualization_msgs::Marker arrow = marker_of(visualization_msgs::Marker::ARROW, id, stamp);
  const double length_m = kShownLength * size_m * std::clamp(load.force_n.norm() / kShownPush_n, 0.2, 1.5);
  const bool pushes = load.marker.empty();  // a weight pulls: its arrow begins where it hangs
  const Eigen::Vector3d way_m = length_m * load.force_n.normalized();
  arrow.points = {to_message(pushes ? Eigen::Vector3d(load.position_m - way_m) : load.position_m),
                  to_message(pushes ? load.position_m : Eigen::Vector3d(load.position_m + way_m))};
  arrow.scale.x = 0.02 * size_m;
  arrow.scale.y = 0.045 * size_m;
  return arrow;
}

// How strong it is, at the arrow's far end.
visualization_msgs::Marker text_of(const EstimatedLoad& load, const visualization_msgs::Marker& arrow, double size_m,
                                   int id, const ros::Time& stamp) {
  visualization_msgs::Marker text = marker_of(visualization_msgs::Marker::TEXT_VIEW_FACING, id, stamp);
  text.pose.position = arrow.points[load.marker.empty() ? 0 : 1];
  text.pose.position.z += 0.05 * size_m;
  text.scale.z = 0.055 * size_m;
  std::ostringstream words;
  words.precision(2);
  words << 1e3 * load.force_n.norm() << " mN";
  text.text = words.str();
  return text;
}

visualization_msgs::Marker ellipsoid_of(const EstimatedLoad& load, double size_m, int id, const ros::Time& stamp) {
  visualization_msgs::Marker ellipsoid = marker_of(visualization_msgs::Marker::SPHERE, id, stamp);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(load.position_covariance_m2);
  Eigen::Matrix3d turn = axes.eigenvectors();
  if (turn.determinant() < 0.0) turn.col(0) *= -1.0;
  const double least_m = 0.01 * size_m;
  const Eigen::Vector3d widths_m = 2.0 * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt().cwiseMax(least_m);
  ellipsoid.pose.position = to_message(load.position_m);
  ellipsoid.pose.orientation = to_message(Eigen::Quaterniond(turn));
  ellipsoid.scale = vector_message(widths_m);
  ellipsoid.color.a = load.observable ? 0.35f : 0.15f;
  return ellipsoid;
}

}  // namespace

std::vector<MeasuredMarker> measured_markers(const MarkerObservations& markers) {
  require_whole(markers);
  if (markers.covariances.size() != 9 * markers.names.size())
    throw std::invalid_argument("covariances: " + std::to_string(markers.covariances.size()) +
                                " numbers are not 9 for each of " + std::to_string(markers.names.size()) + " markers");
  std::vector<MeasuredMarker> seen;
  for (std::size_t i = 0; i < markers.names.size(); ++i) {
    if (markers.sources[i] != MarkerObservations::SEEN) continue;
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> covariance(&markers.covariances[9 * i]);
    seen.push_back({markers.names[i], from_message(markers.positions[i], "positions"), covariance});
  }
  return seen;
}

TwinLoads load_message(const LoadEstimate& estimate, const ros::Time& stamp) {
  TwinLoads message;
  message.header.stamp = stamp;
  message.header.frame_id = robot_frame();
  message.kind = static_cast<std::uint8_t>(estimate.kind);
  message.probability = estimate.probability;
  for (const EstimatedLoad& load : estimate.loads) {
    message.positions.push_back(to_message(load.position_m));
    add(load.position_covariance_m2, message.position_covariances);
    message.forces.push_back(vector_message(load.force_n));
    add(load.force_covariance_n2, message.force_covariances);
    message.observable.push_back(load.observable);
    message.markers.push_back(load.marker);
  }
  message.actuator = estimate.actuator;
  message.change = estimate.change;
  message.chi2_unloaded = estimate.chi2_unloaded;
  message.chi2 = estimate.chi2;
  message.coordinates = estimate.coordinates;
  message.message = estimate.message;
  return message;
}

MarkerObservations estimated_markers(const LoadEstimate& estimate, const ros::Time& stamp) {
  MarkerObservations message;
  message.header.stamp = stamp;
  message.header.frame_id = robot_frame();
  for (const auto& [name, position_m] : estimate.markers_m) {
    message.names.push_back(name);
    message.positions.push_back(to_message(position_m));
  }
  message.covariances.assign(9 * message.names.size(), 0.0);
  message.sources.assign(message.names.size(), MarkerObservations::SIMULATED);
  return message;
}

std::string describe(const LoadEstimate& estimate) {
  switch (estimate.kind) {
    case LoadKind::none:
      return "nothing touches the robot";
    case LoadKind::push:
      return "pushed by " + words(estimate.loads[0]);
    case LoadKind::two_pushes:
      return "pushed by " + words(estimate.loads[0]) + ", and by " + words(estimate.loads[1]);
    case LoadKind::weight:
      return "weighed down by " + words(estimate.loads[0]);
    case LoadKind::modulus: {
      std::ostringstream text;
      text.precision(2);
      text << "stiffer than its model by " << 1e2 * estimate.change << " %; fit it again";
      return text.str();
    }
    case LoadKind::command:
      return "actuator " + estimate.actuator + " stands " + std::to_string(estimate.change) +
             " beside what its drive says; zero it again";
    case LoadKind::frame:
      return "all markers stand elsewhere together: has a camera or the clamp moved? Calibrate again";
    case LoadKind::unknown:
      break;
  }
  return estimate.message;
}

visualization_msgs::MarkerArray load_arrows(const LoadEstimate& estimate, double size_m, const ros::Time& stamp) {
  visualization_msgs::MarkerArray all;
  visualization_msgs::Marker clear = marker_of(visualization_msgs::Marker::ARROW, 0, stamp);
  clear.action = visualization_msgs::Marker::DELETEALL;
  all.markers.push_back(clear);
  int id = 0;
  for (const EstimatedLoad& load : estimate.loads) {
    if (load.force_n.isZero(0.0)) continue;
    const visualization_msgs::Marker arrow = arrow_of(load, size_m, id++, stamp);
    all.markers.push_back(arrow);
    all.markers.push_back(text_of(load, arrow, size_m, id++, stamp));
    if (load.marker.empty()) all.markers.push_back(ellipsoid_of(load, size_m, id++, stamp));
  }
  return all;
}

}  // namespace soft_robot_lab
