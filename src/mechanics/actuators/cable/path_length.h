// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "soft_robot_lab/mechanics/constraint.h"

namespace soft_robot_lab {

// C(x) = length of the polyline through carried points [m]; its multiplier is the tension y [N], the same all along.
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

  // Span `i` from its first to its second end: length and d length / d second end (a unit vector, shorter for a span
  // about to close).
  struct Span {
    double length_m;
    Eigen::Vector3d direction;
    Eigen::Matrix3d curvature;  // second derivative of the length [1/m]
  };
  std::vector<Span> spans(const Eigen::Matrix3Xd& positions_m) const;

  // The law of a given length [m] or, where the length has no say, of a given tension [N]. The last argument: how the
  // length or tension changes with the command.
  void command_length(double length_m, double compliance_m_n, double length_per_command);
  void command_tension(double tension_n, double tension_per_command);

 private:
  std::vector<EmbeddedPoint> points_;
  std::vector<double> closing_lengths_m_;  // per span: below this it counts quadratically
  ConstraintLaw law_;
  double length_m_ = 0.0;
};

}  // namespace soft_robot_lab
