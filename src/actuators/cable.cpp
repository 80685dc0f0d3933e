#include "soft_robot_lab/actuators/cable.h"

#include <cmath>
#include <sstream>

#include "soft_robot_lab/settings/settings_node.h"
#include "soft_robot_lab/sim/body.h"

namespace soft_robot_lab {

PathLength::PathLength(std::vector<EmbeddedPoint> points, const Eigen::Matrix3Xd& rest_positions_m)
    : points_(std::move(points)) {
  const std::vector<Eigen::Vector3d> rest = path(rest_positions_m);
  for (std::size_t i = 1; i < rest.size(); ++i) closing_lengths_m_.push_back(0.1 * (rest[i] - rest[i - 1]).norm());
}

std::vector<Clique> PathLength::cliques() const {
  std::vector<Clique> neighbours;
  for (int i = 1; i < static_cast<int>(points_.size()); ++i) neighbours.push_back({~(i - 1), ~i});
  return neighbours;
}

std::vector<PathLength::Span> PathLength::spans(const Eigen::Matrix3Xd& positions_m) const {
  std::vector<Span> result;
  const std::vector<Eigen::Vector3d> points = path(positions_m);
  for (std::size_t i = 0; i < closing_lengths_m_.size(); ++i) {
    const Eigen::Vector3d vector = points[i + 1] - points[i];
    const double length = vector.norm(), closing = closing_lengths_m_[i];
    if (length > closing) {
      const Eigen::Vector3d unit = vector / length;
      result.push_back({length, unit, (Eigen::Matrix3d::Identity() - unit * unit.transpose()) / length});
    } else {
      result.push_back(
          {0.5 * (length * length / closing + closing), vector / closing, Eigen::Matrix3d::Identity() / closing});
    }
  }
  return result;
}

double PathLength::value(const Eigen::Matrix3Xd& positions_m) const {
  double sum = 0.0;
  for (const Span& span : spans(positions_m)) sum += span.length_m;
  return sum;
}

void PathLength::add_gradient(const Eigen::Matrix3Xd& positions_m, double scale, Eigen::Matrix3Xd& gradient) const {
  const std::vector<Span> all = spans(positions_m);
  const auto pull = [&](const EmbeddedPoint& point, const Eigen::Vector3d& direction) {
    for (std::size_t k = 0; k < point.nodes.size(); ++k) gradient.col(point.nodes[k]) += point.weights[k] * direction;
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    pull(points_[i + 1], scale * all[i].direction);
    pull(points_[i], -scale * all[i].direction);
  }
}

void PathLength::add_hessian(const Eigen::Matrix3Xd& positions_m, double scale, CliqueSink& hessian) const {
  const std::vector<Span> all = spans(positions_m);
  for (std::size_t i = 0; i < all.size(); ++i)
    hessian.add_outer(static_cast<int>(i), {-1.0, 1.0}, scale * all[i].curvature);
}

ConstraintLaw PathLength::law(double value, double) const {
  ConstraintLaw law = law_;
  if (!law.prescribed()) law.offset = value - length_m_;
  return law;
}

void PathLength::command_length(double length_m, double compliance_m_n, double length_per_command) {
  length_m_ = length_m;
  law_ = ConstraintLaw{};
  law_.compliance = compliance_m_n;
  law_.min_multiplier = 0.0;
  law_.offset_per_command = -length_per_command;
}

void PathLength::command_tension(double tension_n, double tension_per_command) {
  law_ = ConstraintLaw{};
  law_.min_multiplier = law_.max_multiplier = tension_n;
  law_.multiplier_per_command = tension_per_command;
}

std::vector<Eigen::Vector3d> PathLength::path(const Eigen::Matrix3Xd& positions_m) const {
  std::vector<Eigen::Vector3d> result;
  for (const EmbeddedPoint& point : points_) result.push_back(point.at(positions_m));
  return result;
}

namespace {

struct Spread {
  double sheath_radius_m, plug_radius_m;
  double box_m;  // of every point; 0 for discs
};

bool held(const EmbeddedPoint& point, const FixedAxes& fixed) {
  for (std::size_t k = 0; k < point.nodes.size(); ++k)
    if (std::abs(point.weights[k]) > 1e-9 && !fixed.col(point.nodes[k]).all()) return false;
  return true;
}

// One via point of the path: moved onto the body where it lies just outside, spread over sheath, plug or box; on held
// material it stays a point.
EmbeddedPoint embed_point(const SettingsNode& item, const std::vector<Eigen::Vector3d>& path, std::size_t i,
                          const Spread& spread, const Body& body, const MeshLocator& locator) {
  const Location location = locator.locate(path[i]);
  const double reach = std::max(spread.sheath_radius_m, 0.5 * spread.box_m) + 1e-9;
  if (location.distance_m > reach) {
    std::ostringstream message;
    message << "point " << i << " at (" << path[i].transpose() << ") m lies " << location.distance_m
            << " m outside the body; the most is the sheath's radius, " << reach
            << " m; the nearest point of the body is (" << location.nearest_m.transpose() << ") m";
    item.fail(message.str());
  }
  const EmbeddedPoint point = locator.embed(location);
  if (held(point, body.fixed())) return point;
  if (spread.box_m > 0.0) return locator.embed_box(location.nearest_m, spread.box_m);
  const bool last = i + 1 == path.size();
  const Eigen::Vector3d along = path[last ? i : i + 1] - path[i == 0 ? i : i - 1];
  return locator.embed_disc(location.nearest_m, along, last ? spread.plug_radius_m : spread.sheath_radius_m);
}

std::vector<Eigen::Vector3d> read_path(const SettingsNode& settings) {
  std::vector<Eigen::Vector3d> path;
  for (const SettingsNode& item : settings.sequence("points_m")) {
    const Eigen::VectorXd point = item.as_numbers();
    if (point.size() != 3) item.fail("a point is [x, y, z] in m");
    path.emplace_back(point);
    if (path.size() > 1 && (path.back() - path[path.size() - 2]).norm() < 1e-9)
      item.fail("repeats the point before it");
  }
  if (path.size() < 2)
    settings.fail("points_m: a cable needs at least two points, this one has " + std::to_string(path.size()));
  return path;
}

}  // namespace

void Cable::on_initialise(const SettingsNode& settings, const Body& body, const MeshLocator& locator) {
  settings.choice_or("model", "sliding", {"sliding"});
  const std::string command = settings.choice_or("command", "contraction", {"contraction", "length_m", "tension_n"});
  kind_ = command == "contraction" ? Command::contraction : command == "length_m" ? Command::length : Command::tension;
  compliance_m_n_ = settings.number_or("compliance_m_n", 1.0e-5, AllowedRange::not_negative());
  Spread spread{};
  spread.sheath_radius_m = settings.number_or("sheath_radius_m", 0.001, AllowedRange::not_negative());
  spread.plug_radius_m = settings.number_or("plug_radius_m", 0.003, AllowedRange::not_negative());
  spread.box_m = settings.number_or("spread_box_m", 0.0, AllowedRange::not_negative());

  const std::vector<Eigen::Vector3d> path = read_path(settings);
  std::vector<EmbeddedPoint> points;
  for (std::size_t i = 0; i < path.size(); ++i) points.push_back(embed_point(settings, path, i, spread, body, locator));
  path_ = std::make_unique<PathLength>(std::move(points), body.mesh().nodes_m);
  rest_length_m_ = path_->value(body.mesh().nodes_m);

  const double pull_speed_m_s = settings.number_or("pull_speed_m_s", 0.0, AllowedRange::not_negative());
  switch (kind_) {
    case Command::contraction:
      limits_ = {1.0, settings.number_or("min_contraction", 0.5, {0.05, 1.0}), 1.5, "1"};
      command_speed_ = pull_speed_m_s / rest_length_m_;
      break;
    case Command::length:
      limits_ = {rest_length_m_, 0.05 * rest_length_m_, 1.5 * rest_length_m_, "m"};
      command_speed_ = pull_speed_m_s;
      break;
    case Command::tension:
      limits_ = {0.0, 0.0, settings.number_or("max_tension_n", 100.0, AllowedRange::positive()), "N"};
      break;
  }
}

void Cable::actuate(double command) {
  switch (kind_) {
    case Command::contraction:
      path_->command_length(command * rest_length_m_, compliance_m_n_, rest_length_m_);
      break;
    case Command::length:
      path_->command_length(command, compliance_m_n_, 1.0);
      break;
    case Command::tension:
      path_->command_tension(command, 1.0);
      break;
  }
}

ActuatorReading Cable::observe(const Eigen::Matrix3Xd& positions_m, const std::vector<double>& multipliers) const {
  ActuatorReading state;
  state.length_m = path_->value(positions_m);
  state.rest_length_m = rest_length_m_;
  state.tension_n = multipliers.at(0);
  state.path_m = path_->path(positions_m);
  return state;
}

}  // namespace soft_robot_lab
