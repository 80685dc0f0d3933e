// A cable that slides through the body and shortens it: one unilateral constraint on the total length of a path.
#pragma once

#include <memory>
#include <vector>

#include "soft_robot_lab/sim/actuator.h"
#include "soft_robot_lab/sim/embedding.h"

namespace soft_robot_lab {

// C(x) = length of the polyline through carried points [m]. Frictionless: the tension y [N] is the same along the path.
// Pulls with y >= 0, C - L = compliance * y; slack when C < L.
class PathLength : public Constraint {
 public:
  // Two or more points; neighbours apart at rest. A span that has shrunk below a tenth of its rest length counts
  // quadratically (Huber 1964), so that its direction fades out instead of flipping where it closes.
  PathLength(std::vector<EmbeddedPoint> points, const Eigen::Matrix3Xd& rest_positions_m);

  std::vector<EmbeddedPoint> carried_points() const override { return points_; }
  std::vector<Clique> cliques() const override;  // neighbouring points
  double value(const Eigen::Matrix3Xd& positions_m) const override;
  void add_gradient(const Eigen::Matrix3Xd& positions_m, double scale, Eigen::Matrix3Xd& gradient) const override;
  void add_hessian(const Eigen::Matrix3Xd& positions_m, double scale, CliqueSink& hessian) const override;
  ConstraintLaw law(double value, double multiplier) const override;

  std::vector<Eigen::Vector3d> path(const Eigen::Matrix3Xd& positions_m) const;

  // The law of a commanded length [m] or, where the length has no say, of a commanded tension [N]. The last argument:
  // how the length or tension changes with the command.
  void command_length(double length_m, double compliance_m_n, double length_per_command);
  void command_tension(double tension_n, double tension_per_command);

 private:
  struct Span {
    double length_m;
    Eigen::Vector3d direction;  // gradient of the length: a unit vector, shorter for a span about to close
    Eigen::Matrix3d curvature;  // second derivative of the length [1/m]
  };
  std::vector<Span> spans(const Eigen::Matrix3Xd& positions_m) const;

  std::vector<EmbeddedPoint> points_;
  std::vector<double> closing_lengths_m_;  // per span: below this it counts quadratically
  ConstraintLaw law_;
  double length_m_ = 0.0;
};

// Plugin "soft_robot_lab/Cable". Settings: name; points_m: [[x, y, z], ...] at rest; model: sliding; command:
// contraction (commanded length / rest length), length_m or tension_n; compliance_m_n >= 0 (0: inextensible);
// sheath_radius_m and plug_radius_m over which points and the end anchor spread, or spread_box_m for every point;
// pull_speed_m_s: the drive's speed, 0 for no limit; min_contraction. Points outside the body by no more than the
// sheath's radius are moved onto it; further out is an error with the place.
class Cable : public Actuator {
 public:
  std::vector<const Constraint*> constraints() const override { return {path_.get()}; }
  ActuatorReading observe(const Eigen::Matrix3Xd& positions_m, const std::vector<double>& multipliers) const override;

 protected:
  void on_initialise(const SettingsNode& settings, const Body& body, const MeshLocator& locator) override;
  void actuate(double command) override;

 private:
  enum class Command { contraction, length, tension };

  Command kind_ = Command::contraction;
  double rest_length_m_ = 0.0;
  double compliance_m_n_ = 0.0;
  std::unique_ptr<PathLength> path_;
};

}  // namespace soft_robot_lab
