// SPDX-License-Identifier: BSD-3-Clause
// A McKibben muscle between two points of the body: a tube in a braid, which shortens as pressure widens it.
//
// Its tension is that of an ideal muscle (Tondu and Lopez, IEEE Control Systems Magazine 20(2), 2000, without the
// braid's friction and the cones at the ends):
//   T = A p (a (L / L0)^2 - b),   a = 3 / tan^2(alpha0),   b = 1 / sin^2(alpha0)
// A: cross-section at rest, p: gauge pressure, L0: length at rest, alpha0: angle between the fibres and the axis at
// rest. Where it has shortened to L0 sqrt(b / a) it does not pull any more, and it never pushes.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <pluginlib/class_list_macros.hpp>

#include "soft_robot_lab/mechanics/actuator.h"
#include "soft_robot_lab/mechanics/body.h"
#include "soft_robot_lab/settings/yaml_node.h"

namespace example_plugin {

using soft_robot_lab::AllowedRange;
using soft_robot_lab::Clique;
using soft_robot_lab::CliqueSink;
using soft_robot_lab::ConstraintLaw;
using soft_robot_lab::DriveState;
using soft_robot_lab::EmbeddedPoint;

struct Braid {
  double rest_length_m = 0.0;
  double area_m2 = 0.0;
  double a = 0.0, b = 0.0;
};

// C(x) = sqrt(|x1 - x0|^2 + e^2), the muscle's length [m]; its multiplier is the tension [N]. By e, a thousandth of the
// rest length, its direction stays defined where both ends meet.
class MuscleLength : public soft_robot_lab::Constraint {
 public:
  MuscleLength(std::vector<EmbeddedPoint> ends, const Braid& braid)
      : ends_(std::move(ends)), braid_(braid), smallest_m_(1e-3 * braid.rest_length_m) {}

  std::vector<EmbeddedPoint> carried_points() const override { return ends_; }
  std::vector<Clique> cliques() const override { return {{~0, ~1}}; }

  double value(const Eigen::Matrix3Xd& positions_m, const DriveState& /*drive*/) const override {
    return muscle_length_m(positions_m);
  }

  double muscle_length_m(const Eigen::Matrix3Xd& positions_m) const {
    return std::hypot(span_m(positions_m).norm(), smallest_m_);
  }

  void add_gradient(const Eigen::Matrix3Xd& positions_m, const DriveState& /*drive*/, double scale,
                    Eigen::Matrix3Xd& gradient) const override {
    const Eigen::Vector3d direction = span_m(positions_m) / muscle_length_m(positions_m);
    for (int end = 0; end < 2; ++end) {
      const EmbeddedPoint& point = ends_[static_cast<std::size_t>(end)];
      for (std::size_t k = 0; k < point.nodes.size(); ++k)
        gradient.col(point.nodes[k]) += (end == 0 ? -scale : scale) * point.weights[k] * direction;
    }
  }

  void add_hessian(const Eigen::Matrix3Xd& positions_m, const DriveState& /*drive*/, double scale,
                   CliqueSink& hessian) const override {
    const double length_m = muscle_length_m(positions_m);
    const Eigen::Vector3d direction = span_m(positions_m) / length_m;
    const Eigen::Matrix3d curvature = (Eigen::Matrix3d::Identity() - direction * direction.transpose()) / length_m;
    hessian.add_outer(0, {-1.0, 1.0}, scale * curvature);
  }

  // The command is the pressure. Solved for the length: c(T) = L0 sqrt((T / (A p) + b) / a), linearised at the present
  // tension.
  ConstraintLaw law(double length_m, double tension_n, const DriveState& drive) const override {
    const double pressure_pa = drive.actuated_command;
    const double stretch = length_m / braid_.rest_length_m;
    ConstraintLaw law;
    law.min_multiplier = 0.0;
    if (pressure_pa == 0.0) {
      law.max_multiplier = 0.0;
      law.multiplier_per_command = std::max(0.0, braid_.area_m2 * (braid_.a * stretch * stretch - braid_.b));
      return law;
    }
    const double pulling_n = std::max(0.0, tension_n);
    const double force_n = braid_.area_m2 * pressure_pa;
    const double free_length_m = braid_.rest_length_m * std::sqrt((pulling_n / force_n + braid_.b) / braid_.a);
    law.compliance = braid_.rest_length_m * braid_.rest_length_m / (2.0 * braid_.a * force_n * free_length_m);
    law.offset = length_m - free_length_m + law.compliance * pulling_n;
    law.offset_per_command = law.compliance * pulling_n / pressure_pa;
    return law;
  }

 private:
  Eigen::Vector3d span_m(const Eigen::Matrix3Xd& positions_m) const {
    return ends_[1].at(positions_m) - ends_[0].at(positions_m);
  }

  std::vector<EmbeddedPoint> ends_;
  Braid braid_;
  double smallest_m_;
};

// Settings: points_m: both ends, at rest on or in the body; diameter_m; braid_angle_deg; max_pressure_pa;
// pressure_rate_pa_s: of the valve, 0 for no limit. Commands are gauge pressures [Pa].
class McKibbenMuscle : public soft_robot_lab::Actuator {
 public:
  std::vector<const soft_robot_lab::Constraint*> constraints() const override { return {length_.get()}; }

  soft_robot_lab::ActuatorReading observe(const Eigen::Matrix3Xd& positions_m, const std::vector<double>& multipliers,
                                          const DriveState& drive) const override {
    soft_robot_lab::ActuatorReading reading;
    for (const EmbeddedPoint& end : length_->carried_points()) reading.path_m.push_back(end.at(positions_m));
    reading.length_m = length_->muscle_length_m(positions_m);
    reading.rest_length_m = rest_length_m_;
    reading.tension_n = multipliers.at(0);
    reading.gauge_pressure_pa = drive.actuated_command;
    return reading;
  }

 protected:
  void on_initialise(const soft_robot_lab::YamlNode& settings, const soft_robot_lab::Body& body,
                     const soft_robot_lab::MeshLocator& locator) override {
    Braid braid;
    const double diameter_m = settings.number("diameter_m", AllowedRange::positive());
    const double angle_rad = pi / 180.0 * settings.number("braid_angle_deg", {0.0, largest_angle_deg, true, true});
    braid.area_m2 = pi / 4.0 * diameter_m * diameter_m;
    braid.a = 3.0 / std::pow(std::tan(angle_rad), 2);
    braid.b = 1.0 / std::pow(std::sin(angle_rad), 2);
    std::vector<EmbeddedPoint> ends = read_ends(settings, locator, diameter_m);
    const Eigen::Matrix3Xd& rest_positions_m = body.mesh().nodes_m;
    rest_length_m_ = (ends[1].at(rest_positions_m) - ends[0].at(rest_positions_m)).norm();
    braid.rest_length_m = rest_length_m_;
    length_ = std::make_unique<MuscleLength>(std::move(ends), braid);
    limits_ = {0.0, 0.0, settings.number("max_pressure_pa", {0.0, 1e7, true, false}), "Pa"};
    command_speed_ = settings.number_or("pressure_rate_pa_s", 0.0, AllowedRange::not_negative());
  }

 private:
  static constexpr double pi = 3.14159265358979323846;
  static constexpr double largest_angle_deg = 54.7;  // at atan(sqrt(2)) pressure neither shortens nor lengthens it

  // Its pull spreads over a disc of its cross-section.
  static std::vector<EmbeddedPoint> read_ends(const soft_robot_lab::YamlNode& settings,
                                              const soft_robot_lab::MeshLocator& locator, double diameter_m) {
    std::vector<Eigen::Vector3d> points_m;
    for (const soft_robot_lab::YamlNode& point : settings.sequence("points_m")) {
      const Eigen::VectorXd numbers = point.as_numbers();
      if (numbers.size() != 3) point.fail("must be [x, y, z]");
      points_m.emplace_back(numbers);
      if (locator.locate(points_m.back()).distance_m > diameter_m)
        point.fail("lies further outside the body than diameter_m");
    }
    if (points_m.size() != 2) settings.child("points_m").fail("must be two points, one for each end");
    if (!((points_m[1] - points_m[0]).norm() > diameter_m))
      settings.child("points_m").fail("must be further apart than diameter_m");
    const Eigen::Vector3d axis = (points_m[1] - points_m[0]).normalized();
    return {locator.embed_disc(points_m[0], axis, diameter_m / 2.0),
            locator.embed_disc(points_m[1], axis, diameter_m / 2.0)};
  }

  double rest_length_m_ = 0.0;
  std::unique_ptr<MuscleLength> length_;
};

}  // namespace example_plugin

PLUGINLIB_EXPORT_CLASS(example_plugin::McKibbenMuscle, soft_robot_lab::Actuator)
