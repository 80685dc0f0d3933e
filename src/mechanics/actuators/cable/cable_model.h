// SPDX-License-Identifier: BSD-3-Clause
// How a cable turns length into tension: one file for each model of the Cable plugin.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "path_length.h"
#include "soft_robot_lab/mechanics/actuator.h"

namespace soft_robot_lab {

// What the drive gives of the cable.
struct DriveCommand {
  bool by_tension = false;
  double length_m = 0.0;     // of the unloaded cable
  double tension_n = 0.0;    // where it is driven
  double per_command = 0.0;  // change of one or the other with the command
};

// How a command is read: what the drive gives at it. Lives as long as the model.
using CommandReader = std::function<DriveCommand(double actuated_command)>;

class CableModel {
 public:
  virtual ~CableModel() = default;

  virtual std::vector<const Constraint*> constraints() const = 0;
  virtual std::vector<const FrictionContact*> friction_contacts() const { return {}; }

  virtual void begin_step(const StepStart& /*start*/, DriveState& /*drive*/) const {}
  virtual void end_step(const std::vector<double>& /*slips_m*/, DriveState& /*drive*/) const {}
  virtual std::string why_no_equilibrium() const { return ""; }
  virtual Eigen::VectorXd initial_memory() const { return {}; }

  // As Actuator::law_change, of a model's own numbers.
  virtual std::optional<LawChange> law_change(const std::string& /*key*/, const Eigen::Matrix3Xd& /*positions_m*/,
                                              const std::vector<double>& /*multipliers*/,
                                              const DriveState& /*drive*/) const {
    return std::nullopt;
  }

  // Tensions from the first span on; one value where it is the same along the cable.
  virtual std::vector<double> tensions_n(const std::vector<double>& multipliers, const DriveState& drive) const = 0;
  virtual double compliance_m_n() const = 0;  // of the whole cable
  virtual const Path& path() const = 0;
};

// Frictionless, one tension. `strings`: of the spans that find their way around obstacles, as of Path.
std::unique_ptr<CableModel> make_sliding_cable(const std::vector<EmbeddedPoint>& points,
                                               const Eigen::Matrix3Xd& rest_positions_m, CommandReader command,
                                               double compliance_m_n, std::vector<SpanString> strings = {});

struct CableFriction {
  double coefficient = 0.0;            // on the points
  std::optional<double> on_obstacles;  // none: the same
};

// Friction on the points as on capstans, and on the obstacles.
std::unique_ptr<CableModel> make_friction_cable(const std::vector<EmbeddedPoint>& points,
                                                const Eigen::Matrix3Xd& rest_positions_m, CommandReader command,
                                                double compliance_m_n, const CableFriction& friction,
                                                std::vector<SpanString> strings = {});

struct SpringSettings {
  double stiffness_n_m = 0.0;  // of each spring, > 0
  double damping_n_s_m = 0.0;  // of each spring
  bool explicit_forces = false;
  bool pseudo_inverse = false;  // only where explicit
};

// One unilateral spring with a damper from point to point.
std::unique_ptr<CableModel> make_spring_cable(const std::vector<EmbeddedPoint>& points,
                                              const Eigen::Matrix3Xd& rest_positions_m, CommandReader command,
                                              const SpringSettings& settings);

}  // namespace soft_robot_lab
