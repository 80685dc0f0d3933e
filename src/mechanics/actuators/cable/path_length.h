// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "soft_robot_lab/mechanics/constraint.h"
#include "taut_string.h"

namespace soft_robot_lab {

// Of a span that finds its way around obstacles; null where it is straight.
using SpanString = std::shared_ptr<const TautString>;

// Neighbouring points of a cable and the spans between them, straight but around obstacles. A span that has shrunk
// below a tenth of its rest length counts quadratically (Huber 1964), so that its direction fades out instead of
// flipping where it closes.
class Path {
 public:
  // Two or more points; neighbours apart at rest. A string for each span, or none.
  Path(std::vector<EmbeddedPoint> points, const Eigen::Matrix3Xd& rest_positions_m,
       std::vector<SpanString> strings = {});

  // Span `i` from its first to its second end: length and d length / d second end (a unit vector, shorter for a span
  // about to close). By the first end it is the opposite, but around obstacles.
  struct Span {
    double length_m;
    Eigen::Vector3d direction;
    Eigen::Matrix3d curvature;  // second derivative of the length by the second end [1/m]
    std::shared_ptr<const TautString::Shape> around = nullptr;  // null where it is straight

    Eigen::Vector3d by_first() const { return around ? around->first : Eigen::Vector3d(-direction); }
    Eigen::Matrix<double, 6, 6> hessian() const;  // by both ends
  };
  std::vector<Span> spans(const Eigen::Matrix3Xd& positions_m) const { return spans_between(places(positions_m)); }
  std::vector<Span> spans_between(const Eigen::Matrix3Xd& places_m) const;
  bool finds_its_way() const { return !strings_.empty(); }
  double length_m(const Eigen::Matrix3Xd& positions_m) const;
  std::vector<Eigen::Vector3d> polyline_m(const Eigen::Matrix3Xd& positions_m) const;  // its points, and those between

  const std::vector<EmbeddedPoint>& points() const { return points_; }
  Eigen::Matrix3Xd places(const Eigen::Matrix3Xd& positions_m) const;  // of the points

 private:
  std::vector<EmbeddedPoint> points_;
  std::vector<SpanString> strings_;
  std::vector<double> closing_lengths_m_;  // per span: below this it counts quadratically
};

// What decides the tension of a piece of cable: a given length [m], C - L = compliance * y, or a given tension [N], of
// which the length knows nothing.
struct CableLaw {
  bool by_tension = false;
  double length_m = 0.0, compliance_m_n = 0.0;
  double tension_n = 0.0;
  double per_command = 0.0;  // change of the length or tension with the command

  static CableLaw of_length(double length_m, double compliance_m_n, double length_per_command) {
    return {false, length_m, compliance_m_n, 0.0, length_per_command};
  }
  static CableLaw of_tension(double tension_n, double tension_per_command) {
    return {true, 0.0, 0.0, tension_n, tension_per_command};
  }
};

ConstraintLaw law_of_length(const CableLaw& cable, double length_m);

// C(x) = length of a path [m]; its multiplier is the tension y [N], the same all along. Pulls with y >= 0; slack when
// C < L.
class PathLength : public Constraint {
 public:
  // `law` reads off the drive what the path follows; it lives as long as this.
  using LawOfDrive = std::function<CableLaw(const DriveState&)>;
  PathLength(std::vector<EmbeddedPoint> points, const Eigen::Matrix3Xd& rest_positions_m, LawOfDrive law,
             std::vector<SpanString> strings = {})
      : path_(std::move(points), rest_positions_m, std::move(strings)), law_(std::move(law)) {}

  std::vector<EmbeddedPoint> carried_points() const override { return path_.points(); }
  std::vector<Clique> cliques() const override;  // neighbouring points
  double value(const Eigen::Matrix3Xd& positions_m, const DriveState& drive) const override;
  void add_gradient(const Eigen::Matrix3Xd& positions_m, const DriveState& drive, double scale,
                    Eigen::Matrix3Xd& gradient) const override;
  void add_hessian(const Eigen::Matrix3Xd& positions_m, const DriveState& drive, double scale,
                   CliqueSink& hessian) const override;
  ConstraintLaw law(double value, double multiplier, const DriveState& drive) const override;

  const Path& path() const { return path_; }

 private:
  Path path_;
  LawOfDrive law_;
};

}  // namespace soft_robot_lab
