// SPDX-License-Identifier: BSD-3-Clause
#include "surface_marker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "soft_robot_lab/mechanics/embedding.h"

namespace soft_robot_lab {
namespace {

constexpr double visible_motion_m = 2.0e-5;
constexpr double see_through = 0.55;  // opacity of a skin that would hide what lies in it
// Okabe and Ito's blue and vermilion, which colour-blind readers distinguish.
const Eigen::Vector3d skin_colour(0.50, 0.80, 0.91), still_air_colour(0.93, 0.90, 0.78);
const Eigen::Vector3d pressure_colour(0.84, 0.37, 0.0), vacuum_colour(0.0, 0.45, 0.70);

Eigen::Vector3d colour_of(double gauge_pressure_pa, double full_pa) {
  const double fraction = std::clamp(std::abs(gauge_pressure_pa) / full_pa, 0.0, 1.0);
  return (1.0 - fraction) * still_air_colour + fraction * (gauge_pressure_pa < 0.0 ? vacuum_colour : pressure_colour);
}

// The share of a path's length that lies inside the body.
double share_inside(const std::vector<Eigen::Vector3d>& path_m, const MeshLocator& locator) {
  constexpr int parts = 8;  // of a span between two points
  double inside_m = 0.0, length_m = 0.0;
  for (std::size_t i = 1; i < path_m.size(); ++i) {
    const Eigen::Vector3d span_m = path_m[i] - path_m[i - 1];
    length_m += span_m.norm();
    for (int part = 0; part < parts; ++part)
      if (locator.locate(path_m[i - 1] + (part + 0.5) / parts * span_m).distance_m == 0.0)
        inside_m += span_m.norm() / parts;
  }
  return length_m > 0.0 ? inside_m / length_m : 0.0;
}

}  // namespace

std_msgs::ColorRGBA shaded(const Eigen::Vector3d& normal, double openness, const Eigen::Vector3d& colour,
                           double opacity) {
  static const Eigen::Vector3d lamp = Eigen::Vector3d(-0.5, -0.75, 0.6).normalized();
  static const Eigen::Vector3d halfway = (lamp + Eigen::Vector3d(0.05, -1.0, 0.1).normalized()).normalized();
  const double sky = (0.60 + 0.10 * normal.z()) * std::sqrt(openness);
  const double direct = 0.48 * std::max(0.0, 0.15 + 0.85 * normal.dot(lamp)) * openness;
  const double gloss = 0.22 * std::pow(std::max(0.0, normal.dot(halfway)), 30.0) * openness;
  const Eigen::Vector3d seen = ((sky + direct) * colour + Eigen::Vector3d::Constant(gloss)).cwiseMin(1.0);
  std_msgs::ColorRGBA rgba;
  rgba.r = static_cast<float>(seen.x());
  rgba.g = static_cast<float>(seen.y());
  rgba.b = static_cast<float>(seen.z());
  rgba.a = static_cast<float>(opacity);
  return rgba;
}

double fitting_opacity(const Simulation& robot) {
  constexpr double most = 0.6;
  const MeshLocator locator(robot.body().mesh());
  for (int i = 0; i < static_cast<int>(robot.actuators().size()); ++i) {
    const ActuatorReading reading = robot.actuator_state(i);
    if (!reading.surface.empty() || share_inside(reading.path_m, locator) > most) return see_through;
  }
  return 1.0;
}

SurfaceMarker::SurfaceMarker(const TetMesh& mesh, double opacity)
    : skin_(mesh), opacity_(opacity), face_surface_(mesh.face_surface), surface_names_(mesh.surface_names) {}

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
  std::vector<bool> lit_within(surface_names_.size() + 1, false);                // a chamber's colour shall be seen
  for (const auto& [name, pressure_pa] : gauge_pressures_pa)
    if (std::isfinite(pressure_pa)) full_gauge_pressure_pa_ = std::max(full_gauge_pressure_pa_, std::abs(pressure_pa));
  for (std::size_t i = 0; i < surface_names_.size(); ++i) {
    const auto pressure = gauge_pressures_pa.find(surface_names_[i]);
    if (pressure == gauge_pressures_pa.end()) continue;
    colours[i] = colour_of(pressure->second, full_gauge_pressure_pa_);
    lit_within[i] = true;
  }
  drawn_positions_m_ = positions_m;
  visualization_msgs::Marker marker;
  marker.header.stamp = stamp;
  marker.header.frame_id = robot_frame();
  marker.ns = "surface";
  marker.type = visualization_msgs::Marker::TRIANGLE_LIST;
  marker.pose.orientation.w = 1.0;
  marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
  marker.color =
      shaded(Eigen::Vector3d::UnitZ(), 1.0, skin_colour, opacity_);  // by its alpha rviz sees whether to look through
  marker.points.reserve(3 * skin_.triangles().size());
  marker.colors.reserve(3 * skin_.triangles().size());
  const Eigen::Matrix3Xd normals = skin_.normals(positions_m);
  for (const auto& [corners, face] : skin_.triangles()) {
    const int surface = face_surface_[static_cast<std::size_t>(face)];
    const std::size_t place = surface < 0 ? surface_names_.size() : static_cast<std::size_t>(surface);
    for (const auto& [node, normal] : corners) {
      marker.points.push_back(to_message(positions_m.col(node)));
      const double openness = lit_within[place] ? 1.0 : skin_.openness()[normal];
      marker.colors.push_back(shaded(normals.col(normal), openness, colours[place], opacity_));
    }
  }
  return marker;
}

namespace {

// The light stays.
visualization_msgs::Marker tinted(visualization_msgs::Marker surface, const std::string& ns,
                                  const Eigen::Vector3d& tint, float opacity) {
  surface.ns = ns;
  surface.color.r = static_cast<float>(tint.x());
  surface.color.g = static_cast<float>(tint.y());
  surface.color.b = static_cast<float>(tint.z());
  surface.color.a = opacity;
  for (std_msgs::ColorRGBA& rgba : surface.colors) {
    const float light = std::min(1.02f, rgba.r / static_cast<float>(skin_colour.x()));
    rgba = surface.color;
    rgba.r *= light;
    rgba.g *= light;
    rgba.b *= light;
  }
  return surface;
}

}  // namespace

visualization_msgs::Marker no_skin(const std::string& ns) {
  visualization_msgs::Marker marker;
  marker.header.frame_id = robot_frame();
  marker.ns = ns;
  marker.action = visualization_msgs::Marker::DELETE;
  return marker;
}

visualization_msgs::Marker ghost_of(visualization_msgs::Marker surface) {
  return tinted(std::move(surface), "ghost", {0.98, 0.62, 0.20}, 0.45f);
}

visualization_msgs::Marker preview_of(visualization_msgs::Marker surface) {
  return tinted(std::move(surface), "preview", {0.45, 0.70, 0.85}, 0.40f);
}

visualization_msgs::Marker twin_skin_of(visualization_msgs::Marker surface) {
  return tinted(std::move(surface), "twin", {0.75, 0.45, 0.85}, 0.45f);
}

visualization_msgs::Marker no_ghost() { return no_skin("ghost"); }

visualization_msgs::Marker no_preview() { return no_skin("preview"); }

visualization_msgs::Marker no_twin_skin() { return no_skin("twin"); }

}  // namespace soft_robot_lab
