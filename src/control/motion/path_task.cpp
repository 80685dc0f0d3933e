// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/control/motion/plan_motion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>

#include "control/refuse.h"
#include "settings/limits.h"
#include "svg_path.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace soft_robot_lab {
namespace {

constexpr int kPieces = 720;       // of a circle or a figure eight: its chords miss it by less than 1e-5 of its size
constexpr int kSplinePieces = 40;  // between two points of a spline
constexpr double kApart_m = 1.0e-9;

using PlanePoints = std::vector<Eigen::Vector2d>;  // across and up [m]

AllowedRange length() { return {0.0, limits::kPlace_m, true, false}; }

PlanePoints circle(const YamlNode& node) {
  const double radius_m = 0.5 * node.number("diameter_m", length());
  PlanePoints points_m;
  for (int i = 0; i <= kPieces; ++i) {
    const double turn_rad = 2.0 * M_PI * i / kPieces;
    points_m.emplace_back(radius_m * std::cos(turn_rad), radius_m * std::sin(turn_rad));
  }
  return points_m;
}

PlanePoints figure_eight(const YamlNode& node) {
  const double width_m = node.number("width_m", length()), height_m = node.number("height_m", length());
  PlanePoints points_m;
  for (int i = 0; i <= kPieces; ++i) {
    const double turn_rad = 2.0 * M_PI * i / kPieces;
    points_m.emplace_back(0.5 * width_m * std::sin(turn_rad), 0.5 * height_m * std::sin(2.0 * turn_rad));
  }
  return points_m;
}

PlanePoints plane_points(const YamlNode& owner, const std::string& key) {
  PlanePoints points_m;
  const std::vector<YamlNode> items = owner.sequence(key);
  if (items.size() < 2 || items.size() > static_cast<std::size_t>(limits::kSplinePoints))
    owner.child(key).fail(std::to_string(items.size()) + " points are out of range [2, " +
                          std::to_string(limits::kSplinePoints) + "]");
  for (const YamlNode& item : items) {
    const Eigen::VectorXd numbers = item.as_numbers();
    if (numbers.size() != 2 || !(numbers.cwiseAbs().maxCoeff() <= limits::kPlace_m))
      item.fail("must be [across, up], each in [-1000, 1000] m");
    points_m.emplace_back(numbers);
    const std::size_t last = points_m.size() - 1;
    if (last > 0 && !((points_m[last] - points_m[last - 1]).norm() > kApart_m))
      item.fail("lies within 1e-9 m of the point before it");
  }
  return points_m;
}

// Catmull-Rom: through all points, its tangent at each along its two neighbours.
PlanePoints spline(const PlanePoints& through_m) {
  const auto point = [&](std::ptrdiff_t i) {
    return through_m[static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(i, 0, static_cast<std::ptrdiff_t>(through_m.size()) - 1))];
  };
  PlanePoints points_m{through_m.front()};
  for (std::ptrdiff_t i = 0; i + 1 < static_cast<std::ptrdiff_t>(through_m.size()); ++i) {
    const Eigen::Vector2d out_m = 0.5 * (point(i + 1) - point(i - 1)), in_m = 0.5 * (point(i + 2) - point(i));
    for (int piece = 1; piece <= kSplinePieces; ++piece) {
      const double t = static_cast<double>(piece) / kSplinePieces, t2 = t * t, t3 = t2 * t;
      points_m.push_back((2 * t3 - 3 * t2 + 1) * point(i) + (t3 - 2 * t2 + t) * out_m +
                         (3 * t2 - 2 * t3) * point(i + 1) + (t3 - t2) * in_m);
    }
  }
  return points_m;
}

// The middle of its bounding box lies at the curve's zero; SVG's y goes down.
PlanePoints svg_path(const YamlNode& node) {
  const double size_m = node.number("size_m", length());
  PlanePoints points;
  try {
    points = svg_points(node.text("d"));
  } catch (const std::invalid_argument& error) {
    node.child("d").fail(error.what());
  }
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : points) box.extend(point);
  const double size = points.empty() ? 0.0 : box.sizes().maxCoeff();
  if (!(size > 0.0)) node.child("d").fail("draws nothing");
  PlanePoints points_m;
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Vector2d from_middle_m = size_m / size * (point - box.center());
    const Eigen::Vector2d point_m(from_middle_m.x(), -from_middle_m.y());
    if (points_m.empty() || (point_m - points_m.back()).norm() > kApart_m) points_m.push_back(point_m);
  }
  if (points_m.size() < 2) node.child("d").fail("draws nothing");
  return points_m;
}

PlanePoints read_curve(const YamlNode& node) {
  const std::vector<std::string> keys = node.keys();
  if (keys.size() != 1) node.fail("needs one of circle, figure_eight, polyline_m, spline_m, svg_path");
  if (keys.front() == "circle") return circle(node.child("circle"));
  if (keys.front() == "figure_eight") return figure_eight(node.child("figure_eight"));
  if (keys.front() == "polyline_m") return plane_points(node, "polyline_m");
  if (keys.front() == "spline_m") return spline(plane_points(node, "spline_m"));
  if (keys.front() == "svg_path") return svg_path(node.child("svg_path"));
  node.fail("'" + keys.front() + "' is not one of circle, figure_eight, polyline_m, spline_m, svg_path");
}

Eigen::Vector3d direction(const YamlNode& plane, const std::string& key) {
  const Eigen::Vector3d along = plane.vector3(key);
  if (!(along.norm() > 1.0e-6 && along.norm() < limits::kNumber))
    plane.child(key).fail("its length is out of range (1e-6, 1e12)");
  return along.normalized();
}

Curve in_space(const YamlNode& plane, const PlanePoints& points_m) {
  const Eigen::Vector3d center_m = plane.vector3("center_m");
  if (!(center_m.cwiseAbs().maxCoeff() <= limits::kPlace_m))
    plane.child("center_m").fail("each number must be in [-1000, 1000] m");
  const Eigen::Vector3d across = direction(plane, "across"), up = direction(plane, "up");
  if (!(std::abs(across.dot(up)) < 1.0e-6)) plane.fail("across and up are not at right angles");
  std::vector<Eigen::Vector3d> places_m;
  for (const Eigen::Vector2d& point_m : points_m)
    places_m.push_back(center_m + point_m.x() * across + point_m.y() * up);
  return Curve(places_m);
}

std::vector<ActuatorBounds> read_bounds(const YamlNode& node) {
  std::vector<ActuatorBounds> bounds;
  for (const std::string& name : node.keys()) {
    const YamlNode one = node.child(name);
    ActuatorBounds asked{name, one.number("min", {-limits::kNumber, limits::kNumber}),
                         one.number("max", {-limits::kNumber, limits::kNumber})};
    if (!(asked.min < asked.max)) one.fail("max: " + std::to_string(asked.max) + " is not above min");
    const AllowedRange some = {0.0, limits::kNumber, true, false};
    if (one.has("max_tension_n")) asked.max_tension_n = one.number("max_tension_n", some);
    if (one.has("max_rate_per_s")) asked.max_rate_per_s = one.number("max_rate_per_s", some);
    bounds.push_back(asked);
  }
  return bounds;
}

PathTask read_path_task(const YamlNode& node) {
  PathTask task;
  task.marker = node.text("marker");
  task.curve = in_space(node.child("plane"), read_curve(node.child("curve")));
  task.tolerance_m = node.number("tolerance_m", length());
  task.duration_s = node.number("duration_s", {0.0, limits::kTime_s});
  task.samples = node.integer_or("samples", task.samples, 2, limits::kSamples);
  if (const auto bounds = node.optional_child("limits")) task.bounds = read_bounds(*bounds);
  node.require_all_read();
  return task;
}

}  // namespace

Curve::Curve(std::vector<Eigen::Vector3d> points_m) : points_m_(std::move(points_m)) {
  if (points_m_.size() < 2) refuse("a curve of ", points_m_.size(), " points, must be at least 2");
  ways_m_.push_back(0.0);
  for (std::size_t i = 0; i < points_m_.size(); ++i) {
    if (!points_m_[i].allFinite()) refuse("point ", i, " of a curve is not finite");
    if (i == 0) continue;
    const double piece_m = (points_m_[i] - points_m_[i - 1]).norm();
    if (!(piece_m > kApart_m)) refuse("point ", i, " of a curve lies within 1e-9 m of the one before it");
    ways_m_.push_back(ways_m_.back() + piece_m);
  }
}

Eigen::Vector3d Curve::at(double way_m) const {
  if (!(way_m > 0.0)) return points_m_.front();
  const auto next = std::upper_bound(ways_m_.begin(), ways_m_.end(), way_m);
  if (next == ways_m_.end()) return points_m_.back();
  const auto i = static_cast<std::size_t>(next - ways_m_.begin());
  const double share = (way_m - ways_m_[i - 1]) / (ways_m_[i] - ways_m_[i - 1]);
  return points_m_[i - 1] + share * (points_m_[i] - points_m_[i - 1]);
}

PathTask load_path_task(const std::string& file) { return read_path_task(YamlNode::load_file(file)); }

PathTask parse_path_task(const std::string& text, const std::string& source_name) {
  return read_path_task(YamlNode::parse(text, source_name));
}

}  // namespace soft_robot_lab
