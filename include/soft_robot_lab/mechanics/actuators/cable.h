// SPDX-License-Identifier: BSD-3-Clause
// A cable that runs through the body and shortens it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "soft_robot_lab/mechanics/actuator.h"

namespace soft_robot_lab {

class CableModel;
struct DriveCommand;

// Plugin "soft_robot_lab/Cable". Its first point is where the drive pulls, its last is the plug. Settings:
//   name
//   points_m: [[x, y, z], ...] at rest. Points outside the body by no more than the sheath's radius are moved onto it,
//     which is reported; further out is an error with the place. Between its points the cable is straight, and may be
//     free.
//   path_m: [[x, y, z], ...] instead: the corners of its path. Where that leaves and enters the body points are set: in
//     the silicone the cable is in a sheath, elsewhere free. A corner in the air, and a leg along the skin, are errors.
//   spline_m: [[x, y, z], ...] instead: control points of a cubic B-spline from the first to the last; then as path_m,
//     but the curve may pass through air
//   via_points: given, those above alone (default of points_m); or per_element (of path_m and spline_m), beside them
//     one in the middle of the cable's way through every element of the mesh that it crosses and that holds none of
//     them
//   around: [name, ...] of the body's obstacles that stand still: spans in the air lie on them and slide along them. In
//     place of a name {obstacle: name, by_m: [x, y, z]}, where by_m says on which side of it
//   model: sliding (one tension along the path), friction (tension falls by exp(-friction_coefficient * angle) at each
//     point, against the slip; on obstacles by friction_on_obstacles, which is the same unless given), or springs (one
//     unilateral spring from point to point, as the thesis has it)
//   command: contraction (commanded length / rest length), length_m or tension_n
//   compliance_m_n >= 0 of the whole cable (0: inextensible); of springs stiffness_n_m > 0 of each, damping_n_s_m >= 0,
//     integration: implicit, or explicit (forces of the step's start), coupling: transpose, or pseudo_inverse (explicit
//     only: forces reach the nodes by the pseudo-inverse of the interpolation, which multiplies them)
//   length_offset_m: by which the cable is longer than commanded, as where a drive's zero is off
//   pretension_n: tension it is mounted with in the rest shape
//   sheath_radius_m and plug_radius_m over which points and plug spread, or spread_box_m for every point
//   pull_speed_m_s and pull_delay_s: the drive's speed (0: no limit) and its delay before it starts
//   min_contraction, or max_tension_n
class Cable : public Actuator {
 public:
  Cable();
  ~Cable() override;
  std::vector<const Constraint*> constraints() const override;
  std::vector<const FrictionContact*> friction_contacts() const override;
  void begin_step(const StepStart& start, DriveState& drive) const override;
  void end_step(const std::vector<double>& slips_m, DriveState& drive) const override;
  std::string why_no_equilibrium() const override;
  // Keys: length_offset_m, and by model compliance_m_n, friction_coefficient.
  std::optional<LawChange> law_change(const std::string& key, const Eigen::Matrix3Xd& positions_m,
                                      const std::vector<double>& multipliers, const DriveState& drive) const override;
  ActuatorReading observe(const Eigen::Matrix3Xd& positions_m, const std::vector<double>& multipliers,
                          const DriveState& drive) const override;

 protected:
  void on_initialise(const YamlNode& settings, const Body& body, const MeshLocator& locator) override;
  Eigen::VectorXd initial_memory() const override;

 private:
  enum class Command { contraction, length, tension };

  double unloaded_length_m(double actuated_command) const;
  DriveCommand drive_command(double actuated_command) const;

  Command kind_ = Command::contraction;
  double rest_length_m_ = 0.0;
  double pretension_n_ = 0.0;
  double length_offset_m_ = 0.0;
  std::vector<EmbeddedPoint> points_;
  std::vector<PathChange> path_changes_;
  std::unique_ptr<CableModel> model_;
};

}  // namespace soft_robot_lab
