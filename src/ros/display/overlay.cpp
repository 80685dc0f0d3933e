// SPDX-License-Identifier: BSD-3-Clause
#include "overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "ros/messages/conversions.h"
#include "ros/messages/frames.h"
#include "overlay_names.h"
#include "plasma.h"
#include "settings/words.h"

namespace soft_robot_lab {
namespace {

using Shape = visualization_msgs::Marker;

std_msgs::ColorRGBA colour(float red, float green, float blue, float alpha = 1.0f) {
  std_msgs::ColorRGBA rgba;
  rgba.r = red;
  rgba.g = green;
  rgba.b = blue;
  rgba.a = alpha;
  return rgba;
}

const std_msgs::ColorRGBA simulated_colour = colour(0.10f, 0.25f, 0.80f);
const std_msgs::ColorRGBA measured_colour = colour(0.85f, 0.10f, 0.75f);
const std_msgs::ColorRGBA unsure_colour = colour(0.85f, 0.10f, 0.75f, 0.25f);
const std_msgs::ColorRGBA hidden_colour = colour(0.95f, 0.55f, 0.05f, 0.35f);
const std_msgs::ColorRGBA target_colour = colour(0.95f, 0.55f, 0.05f, 0.85f);
const std_msgs::ColorRGBA error_colour = colour(0.85f, 0.10f, 0.10f);
const std_msgs::ColorRGBA contact_colour = colour(0.80f, 0.20f, 0.05f);
const std_msgs::ColorRGBA sticking_colour = colour(0.10f, 0.55f, 0.20f, 0.7f);
const std_msgs::ColorRGBA slipping_colour = colour(0.85f, 0.35f, 0.05f, 0.7f);
const std_msgs::ColorRGBA text_colour = colour(0.10f, 0.10f, 0.10f);

// Texts, and what belongs to them: a window lays these out, so that they have a fixed size and overlap nothing.
bool is_label(const std::string& ns) {
  static const std::set<std::string> names = {"simulated_names",  "measured_names",     "cable_tensions",
                                              "gap_text",         "chamber_pressures",  "contact_forces",
                                              overlay_names::gap, overlay_names::error, overlay_names::tension_scale};
  return names.count(ns) > 0;
}

// Collects shapes; each has a name of its own within its namespace, and the number that it had before.
class Drawing {
 public:
  Drawing(const OverlayOptions& options, const ros::Time& stamp, const OverlayNumbers& before, int& next)
      : options_(options), stamp_(stamp), before_(before), next_(next) {}

  void sphere(const std::string& ns, const std::string& name, const geometry_msgs::Point& centre, double radius_m,
              const std_msgs::ColorRGBA& rgba) {
    Shape& shape = add(ns, name, Shape::SPHERE, rgba);
    shape.pose.position = centre;
    shape.scale.x = shape.scale.y = shape.scale.z = 2.0 * radius_m;
  }

  void ellipsoid(const std::string& ns, const std::string& name, const geometry_msgs::Point& centre,
                 const Eigen::Quaterniond& turn, const Eigen::Vector3d& semi_axes_m, const std_msgs::ColorRGBA& rgba) {
    Shape& shape = add(ns, name, Shape::SPHERE, rgba);
    shape.pose.position = centre;
    shape.pose.orientation = to_message(turn);
    shape.scale.x = 2.0 * semi_axes_m.x();
    shape.scale.y = 2.0 * semi_axes_m.y();
    shape.scale.z = 2.0 * semi_axes_m.z();
  }

  Shape& line(const std::string& ns, const std::string& name, const std::vector<geometry_msgs::Point>& points,
              double width_m, const std_msgs::ColorRGBA& rgba, const std::vector<std_msgs::ColorRGBA>& along = {}) {
    Shape& shape = add(ns, name, Shape::LINE_STRIP, rgba);
    shape.points = points;
    shape.colors = along;
    shape.scale.x = width_m;
    return shape;
  }

  void arrow(const std::string& ns, const std::string& name, const Eigen::Vector3d& from_m,
             const Eigen::Vector3d& way_m, double width_m, const std_msgs::ColorRGBA& rgba) {
    Shape& shape = add(ns, name, Shape::ARROW, rgba);
    shape.points = {to_message(from_m), to_message(from_m + way_m)};
    shape.scale.x = width_m;
    shape.scale.y = 2.0 * width_m;
  }

  void disc(const std::string& ns, const std::string& name, const Eigen::Vector3d& center_m,
            const Eigen::Vector3d& normal, double area_m2, const std_msgs::ColorRGBA& rgba) {
    Shape& shape = add(ns, name, Shape::CYLINDER, rgba);
    const auto turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal);
    shape.pose.position = to_message(center_m);
    shape.pose.orientation = to_message(turn);
    shape.scale.x = shape.scale.y = 2.0 * std::sqrt(area_m2 / M_PI);
    shape.scale.z = 0.1 * options_.text_height_m;
  }

  void text(const std::string& ns, const std::string& name, const geometry_msgs::Point& place,
            const std::string& words) {
    Shape& shape = add(ns, name, Shape::TEXT_VIEW_FACING, text_colour);
    shape.pose.position = place;
    shape.scale.z = options_.text_height_m;
    shape.text = words;
  }

  // With what was shown before and is not now deleted.
  DrawnOverlay finished() {
    for (const auto& [key, number] : before_) {
      if (numbers_.count(key) > 0) continue;
      Shape gone = shape_of(key.first, number);
      gone.action = Shape::DELETE;
      markers_of(key.first).push_back(gone);
    }
    return std::move(drawn_);
  }

  const OverlayNumbers& numbers() const { return numbers_; }

 private:
  Shape& add(const std::string& ns, std::string name, int type, const std_msgs::ColorRGBA& rgba) {
    while (numbers_.count({ns, name}) > 0) name += '\'';
    const auto before = before_.find({ns, name});
    const int number = before != before_.end() ? before->second : next_++;
    numbers_[{ns, name}] = number;
    Shape shape = shape_of(ns, number);
    shape.type = type;
    shape.color = rgba;
    shape.lifetime = ros::Duration(1.0);  // all vanishes with the node
    markers_of(ns).push_back(shape);
    return markers_of(ns).back();
  }

  std::vector<Shape>& markers_of(const std::string& ns) {
    return is_label(ns) ? drawn_.labels.markers : drawn_.shapes.markers;
  }

  Shape shape_of(const std::string& ns, int number) const {
    Shape shape;
    shape.header.stamp = stamp_;
    shape.header.frame_id = robot_frame();
    shape.ns = ns;
    shape.id = number;
    shape.pose.orientation.w = 1.0;
    return shape;
  }

  const OverlayOptions& options_;
  ros::Time stamp_;
  const OverlayNumbers& before_;
  int& next_;
  OverlayNumbers numbers_;
  DrawnOverlay drawn_;
};

// Names that are written already are not written again: two of them half over each other cannot be read.
void draw_markers(const MarkerObservations& markers, const std::string& ns, const std_msgs::ColorRGBA& rgba,
                  const std::vector<std::string>& written, const OverlayOptions& options, Drawing& drawing) {
  for (size_t i = 0; i < markers.names.size(); ++i) {
    drawing.sphere(ns, markers.names[i], markers.positions[i], options.marker_radius_m, rgba);
    if (std::find(written.begin(), written.end(), markers.names[i]) != written.end()) continue;
    drawing.text(ns + "_names", markers.names[i], markers.positions[i], markers.names[i]);
  }
}

// Three standard deviations along each axis, which hold 97 of 100 places. Of a hidden marker it grows until it is seen
// again; of one that is seen it mostly lies within its ball.
void draw_covariances(const MarkerObservations& markers, Drawing& drawing) {
  constexpr double deviations = 3.0, least_m = 1e-4;
  if (markers.covariances.size() != 9 * markers.names.size()) return;
  for (size_t i = 0; i < markers.names.size(); ++i) {
    const Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Map(&markers.covariances[9 * i]);
    if (!covariance_m2.allFinite() || covariance_m2.isZero(0.0)) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solved(0.5 * (covariance_m2 + covariance_m2.transpose()));
    Eigen::Matrix3d axes = solved.eigenvectors();
    if (axes.determinant() < 0.0) axes.col(0) *= -1.0;
    const Eigen::Vector3d semi_axes_m = deviations * solved.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    const bool hidden = markers.sources[i] == MarkerObservations::INTERPOLATED;
    drawing.ellipsoid("covariances", markers.names[i], markers.positions[i], Eigen::Quaterniond(axes),
                      semi_axes_m.cwiseMax(least_m), hidden ? hidden_colour : unsure_colour);
  }
}

// Fades towards its past.
void draw_trail(const Trail& trail, const std::string& ns, std_msgs::ColorRGBA rgba, const OverlayOptions& options,
                Drawing& drawing) {
  if (trail.points().size() < 2) return;
  std::vector<geometry_msgs::Point> points;
  std::vector<std_msgs::ColorRGBA> colours;
  const double now_s = trail.points().back().first;
  for (const auto& [time_s, point] : trail.points()) {
    rgba.a = static_cast<float>(std::clamp(1.0 - (now_s - time_s) / options.trail_s, 0.05, 0.9));
    points.push_back(point);
    colours.push_back(rgba);
  }
  drawing.line(ns, "trail", points, 0.6 * options.cable_width_m, rgba, colours);
}

std_msgs::ColorRGBA tension_colour(double fraction) {
  const auto [red, green, blue] = plasma(fraction);
  return colour(red, green, blue);
}

// 1, 2 or 5 times a power of ten, not below it.
double round_up(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0})
    if (value <= step * decade * (1.0 + 1e-9)) return step * decade;
  return 10.0 * decade;
}

void draw_tension_scale(const geometry_msgs::Point& middle, double full_tension_n, const OverlayOptions& options,
                        Drawing& drawing) {
  const double half_m = 5.0 * options.text_height_m;
  constexpr int parts = 16;
  std::vector<geometry_msgs::Point> points(parts + 1, middle);
  std::vector<std_msgs::ColorRGBA> colours;
  for (int i = 0; i <= parts; ++i) {
    points[static_cast<size_t>(i)].x += half_m * (2.0 * i / parts - 1.0);
    colours.push_back(tension_colour(static_cast<double>(i) / parts));
  }
  drawing.line(overlay_names::tension_scale, "bar", points, 0.6 * options.text_height_m, colours.front(), colours)
      .text = format_number(full_tension_n) + " N";
}

void draw_cables(const ActuatorState& actuators, double full_tension_n, const OverlayOptions& options,
                 Drawing& drawing) {
  std::optional<geometry_msgs::Point> top;
  for (const CableState& cable : actuators.cables) {
    if (cable.path.size() < 2) continue;
    drawing.line("cables", cable.name, cable.path, options.cable_width_m,
                 tension_colour(cable.tension_n / full_tension_n));
    const geometry_msgs::Point& place = cable.path.front();
    if (!top || place.z > top->z) top = place;
    drawing.text("cable_tensions", cable.name, place, cable.name + " " + format_fixed(cable.tension_n, 1) + " N");
  }
  if (!top) return;
  top->x = 0.0;
  top->z += 6.2 * options.text_height_m;
  draw_tension_scale(*top, full_tension_n, options, drawing);
}

void draw_chambers(const ActuatorState& actuators, Drawing& drawing) {
  for (const ChamberState& chamber : actuators.chambers) {
    drawing.text("chamber_pressures", chamber.name, chamber.centre,
                 chamber.name + " " + format_fixed(1e-3 * chamber.gauge_pressure_pa, 1) + " kPa\n" +
                     format_fixed(1e6 * chamber.volume_m3, 1) + " ml");
  }
}

// An arrow for the force on the first surface, and a disc as large as the area under pressure: green where most of it
// sticks, or nothing rubs.
void draw_contacts(const Contacts& contacts, const OverlayOptions& options, Drawing& drawing) {
  constexpr double kLongest_m = 0.06;
  for (const Contact& contact : contacts.contacts) {
    const std::string name = contact.first + " " + contact.second;
    const Eigen::Vector3d center_m = from_message(contact.center, "center");
    const Eigen::Vector3d normal = from_message(contact.normal, "normal");
    Eigen::Vector3d way_m = options.arrow_m_n * from_message(contact.force, "force");
    if (way_m.norm() > kLongest_m) way_m *= kLongest_m / way_m.norm();
    if (!way_m.isZero(1e-4))
      drawing.arrow("contacts", name, center_m, way_m, 1.2 * options.cable_width_m, contact_colour);
    if (contact.area_m2 > 0.0 && !normal.isZero())
      drawing.disc("contact_areas", name, center_m, normal, contact.area_m2,
                   contact.slipping_area_m2 > contact.sticking_area_m2 ? slipping_colour : sticking_colour);
    drawing.text("contact_forces", name, contact.center, format_fixed(contact.normal_force_n, 2) + " N");
  }
}

void draw_target(const Target& target, const OverlayOptions& options, Drawing& drawing) {
  drawing.sphere("target", target.marker, target.position, options.target_radius_m, target_colour);
}

// A line from each simulated to its measured marker, with its length, where cameras see it.
void draw_gap(const RealityGap& gap, const OverlayOptions& options, Drawing& drawing) {
  for (size_t i = 0; i < gap.names.size(); ++i) {
    if (gap.seen[i] == 0) continue;
    const geometry_msgs::Point& measured = gap.measured[i];
    geometry_msgs::Point simulated = measured;
    simulated.x -= gap.gaps[i].x;
    simulated.y -= gap.gaps[i].y;
    simulated.z -= gap.gaps[i].z;
    drawing.line("gap", gap.names[i], {simulated, measured}, 0.5 * options.cable_width_m, error_colour);
    drawing.text("gap_text", gap.names[i], measured, format_fixed(1e3 * gap.distances_m[i], 2) + " mm");
  }
  geometry_msgs::Point above;
  above.z = 8.4 * options.text_height_m;  // above the axes of the frame and the scale of tensions
  drawing.text(overlay_names::gap, "rms", above, "gap " + format_fixed(1e3 * gap.rms_m, 2) + " mm rms");
}

void draw_error(const MarkerObservations& markers, const Target& target, const OverlayOptions& options,
                Drawing& drawing) {
  const auto found = std::find(markers.names.begin(), markers.names.end(), target.marker);
  if (found == markers.names.end()) return;
  const geometry_msgs::Point& from = markers.positions[found - markers.names.begin()];
  const geometry_msgs::Point& to = target.position;
  const double distance_m = std::hypot(to.x - from.x, to.y - from.y, to.z - from.z);
  drawing.line(overlay_names::error, target.marker, {from, to}, 0.5 * options.cable_width_m, error_colour).text =
      format_fixed(1e3 * distance_m, 2) + " mm";
}

void require_number(double value, const char* field) {
  if (!std::isfinite(value)) throw std::invalid_argument(std::string(field) + ": must be a finite number");
}

void require_whole(const ActuatorState& actuators) {
  for (const CableState& cable : actuators.cables) {
    require_number(cable.tension_n, "tension_n");
    for (const geometry_msgs::Point& point : cable.path) from_message(point, "path");
  }
  for (const ChamberState& chamber : actuators.chambers) {
    from_message(chamber.centre, "centre");
    require_number(chamber.gauge_pressure_pa, "gauge_pressure_pa");
    require_number(chamber.volume_m3, "volume_m3");
  }
}

void require_whole(const Contacts& contacts) {
  for (const Contact& contact : contacts.contacts) {
    from_message(contact.center, "center");
    from_message(contact.normal, "normal");
    from_message(contact.force, "force");
    require_number(contact.normal_force_n, "normal_force_n");
    for (const double area_m2 : {contact.area_m2, contact.sticking_area_m2, contact.slipping_area_m2})
      if (!(area_m2 >= 0.0 && area_m2 <= 1e6)) throw std::invalid_argument("area_m2: must be in [0, 1e6]");
  }
}

void require_whole(const RealityGap& gap) {
  const size_t count = gap.names.size();
  for (const size_t size : {gap.measured.size(), gap.gaps.size(), gap.distances_m.size(), gap.seen.size()})
    if (size != count) throw std::invalid_argument("gap: lists of different lengths");
  for (size_t i = 0; i < count; ++i) {
    geometry_msgs::Point end;
    end.x = gap.gaps[i].x;
    end.y = gap.gaps[i].y;
    end.z = gap.gaps[i].z;
    from_message(gap.measured[i], "measured");
    from_message(end, "gaps");
    require_number(gap.distances_m[i], "distances_m");
  }
  require_number(gap.rms_m, "rms_m");
}

}  // namespace

void Trail::add(const MarkerObservations& markers, double now_s, double kept_s) {
  constexpr double step_m = 2e-4;  // nearer to the last point nothing new is seen
  if (!points_.empty() && now_s < points_.back().first) points_.clear();
  while (!points_.empty() && points_.front().first < now_s - kept_s) points_.pop_front();
  if (markers.names.empty()) return;
  auto found = std::find(markers.names.begin(), markers.names.end(), "tip");
  if (found == markers.names.end()) --found;
  if (*found != marker_) points_.clear();
  marker_ = *found;
  const geometry_msgs::Point& at = markers.positions[static_cast<size_t>(found - markers.names.begin())];
  if (!points_.empty()) {
    const geometry_msgs::Point& last = points_.back().second;
    if (std::hypot(at.x - last.x, at.y - last.y, at.z - last.z) < step_m) return;
  }
  points_.emplace_back(now_s, at);
}

DrawnOverlay Overlay::draw(const OverlayInputs& inputs, const ros::Time& stamp) {
  for (const MarkerObservations* markers : {&inputs.simulated, &inputs.measured}) require_whole(*markers);
  require_whole(inputs.actuators);
  if (inputs.gap) require_whole(*inputs.gap);
  require_whole(inputs.contacts);
  Drawing drawing(options_, stamp, shown_, next_);
  draw_markers(inputs.simulated, "simulated", simulated_colour, {}, options_, drawing);
  draw_markers(inputs.measured, "measured", measured_colour, inputs.simulated.names, options_, drawing);
  draw_covariances(inputs.measured, drawing);
  simulated_trail_.add(inputs.simulated, stamp.toSec(), options_.trail_s);
  measured_trail_.add(inputs.measured, stamp.toSec(), options_.trail_s);
  draw_trail(simulated_trail_, "simulated_trail", simulated_colour, options_, drawing);
  draw_trail(measured_trail_, "measured_trail", measured_colour, options_, drawing);
  if (inputs.gap) draw_gap(*inputs.gap, options_, drawing);
  double full_tension_n = std::max(full_tension_n_, options_.full_tension_n);
  for (const CableState& cable : inputs.actuators.cables)
    if (cable.tension_n > full_tension_n) full_tension_n = round_up(cable.tension_n);
  draw_cables(inputs.actuators, full_tension_n, options_, drawing);
  draw_chambers(inputs.actuators, drawing);
  draw_contacts(inputs.contacts, options_, drawing);
  if (inputs.target) {
    from_message(inputs.target->position, "target");
    draw_target(*inputs.target, options_, drawing);
    draw_error(inputs.measured.names.empty() ? inputs.simulated : inputs.measured, *inputs.target, options_, drawing);
  }
  DrawnOverlay drawn = drawing.finished();
  shown_ = drawing.numbers();
  full_tension_n_ = full_tension_n;
  return drawn;
}

void Overlay::forget() {
  simulated_trail_ = {};
  measured_trail_ = {};
  full_tension_n_ = 0.0;
}

}  // namespace soft_robot_lab
