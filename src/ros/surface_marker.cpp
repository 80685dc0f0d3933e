// SPDX-License-Identifier: BSD-3-Clause
#include "surface_marker.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "conversions.h"
#include "topics.h"

namespace soft_robot_lab {
namespace {

constexpr double visible_motion_m = 2.0e-5;
constexpr double full_gauge_pressure_pa = 20000.0;  // as red, or below zero as blue, as it gets
const Eigen::Vector3d skin_colour(0.62, 0.80, 0.95), still_air_colour(0.55, 0.85, 0.55);
const Eigen::Vector3d pressure_colour(0.95, 0.20, 0.10), vacuum_colour(0.15, 0.20, 0.90);

//         2
//        / \          a face with mid-edge nodes 3 (01), 4 (12), 5 (20)
//       5---4         becomes four triangles
//      / \ / \        .
//     0---3---1
constexpr int quarters[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};

// Shaded here and not by rviz, whose light leaves the far side of a translucent skin black and its triangles patchy.
std_msgs::ColorRGBA shaded(const Eigen::Vector3d& normal, const Eigen::Vector3d& colour) {
  const Eigen::Vector3d towards_light = Eigen::Vector3d(-0.4, -0.7, 0.6).normalized();
  const double length = normal.norm();
  const double light = length > 0.0 ? 0.75 + 0.25 * normal.dot(towards_light) / length : 0.75;
  std_msgs::ColorRGBA rgba;
  rgba.r = static_cast<float>(colour.x() * light);
  rgba.g = static_cast<float>(colour.y() * light);
  rgba.b = static_cast<float>(colour.z() * light);
  rgba.a = 0.6f;  // cables inside shall be seen
  return rgba;
}

Eigen::Vector3d colour_of(double gauge_pressure_pa) {
  const double fraction = std::clamp(std::abs(gauge_pressure_pa) / full_gauge_pressure_pa, 0.0, 1.0);
  return (1.0 - fraction) * still_air_colour + fraction * (gauge_pressure_pa < 0.0 ? vacuum_colour : pressure_colour);
}

}  // namespace

SurfaceMarker::SurfaceMarker(const TetMesh& mesh) : surface_names_(mesh.surface_names) {
  for (int f = 0; f < mesh.faces.cols(); ++f) {
    const auto face = mesh.faces.col(f);
    const int surface = mesh.face_surface[static_cast<std::size_t>(f)];
    if (face.size() == 3) {
      triangles_.push_back({{face(0), face(1), face(2)}, surface});
    } else {
      for (const auto& q : quarters) triangles_.push_back({{face(q[0]), face(q[1]), face(q[2])}, surface});
    }
  }
}

bool SurfaceMarker::moved(const Eigen::Matrix3Xd& positions_m) const {
  if (drawn_positions_m_.cols() != positions_m.cols()) return true;
  return (positions_m - drawn_positions_m_).cwiseAbs().maxCoeff() > visible_motion_m;
}

void SurfaceMarker::follow_clock(const ros::Time& stamp) {
  if (stamp < followed_) forget();
  followed_ = stamp;
}

visualization_msgs::Marker SurfaceMarker::message(const Eigen::Matrix3Xd& positions_m, const ros::Time& stamp,
                                                  const std::map<std::string, double>& gauge_pressures_pa) {
  std::vector<Eigen::Vector3d> colours(surface_names_.size() + 1, skin_colour);  // the last for faces without a name
  for (std::size_t i = 0; i < surface_names_.size(); ++i) {
    const auto pressure = gauge_pressures_pa.find(surface_names_[i]);
    if (pressure != gauge_pressures_pa.end()) colours[i] = colour_of(pressure->second);
  }
  drawn_positions_m_ = positions_m;
  visualization_msgs::Marker marker;
  marker.header.stamp = stamp;
  marker.header.frame_id = topics::robot_frame;
  marker.ns = "surface";
  marker.type = visualization_msgs::Marker::TRIANGLE_LIST;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color = shaded(Eigen::Vector3d::UnitZ(), skin_colour);  // rviz sees by its alpha that the skin is translucent
  marker.points.reserve(3 * triangles_.size());
  marker.colors.reserve(triangles_.size());
  for (const auto& [nodes, surface] : triangles_) {
    const auto& [a, b, c] = nodes;
    const std::size_t colour = surface < 0 ? surface_names_.size() : static_cast<std::size_t>(surface);
    for (const int node : {a, b, c}) marker.points.push_back(to_message(positions_m.col(node)));
    const Eigen::Vector3d edge_m = positions_m.col(b) - positions_m.col(a);
    marker.colors.push_back(shaded(edge_m.cross(positions_m.col(c) - positions_m.col(a)), colours[colour]));
  }
  return marker;
}

visualization_msgs::Marker ghost_of(visualization_msgs::Marker surface) {
  surface.ns = "ghost";
  surface.color.r = 0.98f;
  surface.color.g = 0.62f;
  surface.color.b = 0.20f;
  surface.color.a = 0.35f;
  for (std_msgs::ColorRGBA& rgba : surface.colors) {  // the light stays
    const float light = rgba.r / static_cast<float>(skin_colour.x());
    rgba = surface.color;
    rgba.r *= light;
    rgba.g *= light;
    rgba.b *= light;
  }
  return surface;
}

visualization_msgs::Marker no_ghost() {
  visualization_msgs::Marker marker;
  marker.header.frame_id = topics::robot_frame;
  marker.ns = "ghost";
  marker.action = visualization_msgs::Marker::DELETE;
  return marker;
}

}  // namespace soft_robot_lab
