// SPDX-License-Identifier: BSD-3-Clause
// The plugin interface of everything that drives the body: cables, air chambers, and what a lab adds of its own.
// Called in this order: initialise once, after which nothing of the actuator changes; then per command set_command; per
// time step begin_step and advance; per solver iteration the constraints; when the step is accepted end_step; after a
// solve observe. All that changes is in the DriveState that each of these is handed, so that simulations in several
// threads share one actuator. A plugin without a memory of its own has only on_initialise, constraints and observe.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "constraint.h"
#include "drive_state.h"

namespace soft_robot_lab {

class Body;
class MeshLocator;
class YamlNode;

// A point of the path that lay outside the body and was moved onto it.
struct PathChange {
  int point = 0;  // counted from 0
  double moved_m = 0.0;
};

// What an actuator measures; members that make no sense for its kind stay empty.
struct ActuatorReading {
  std::string name;
  double command = 0.0;           // as last commanded
  double actuated_command = 0.0;  // as reached within the speed limit
  std::optional<double> length_m;
  std::optional<double> rest_length_m;
  std::optional<double> commanded_length_m;  // that of actuated_command
  std::optional<double> tension_n;           // where it is driven, at its first point
  std::optional<double> stretch_m;           // by which its material is longer than without tension
  std::optional<double> slack_m;             // by which its material is longer than its path
  std::optional<double> pretension_n;        // with which it was mounted in the rest shape
  std::vector<double> span_tensions_n;       // from its first point on, where they may differ
  std::vector<PathChange> path_changes;
  std::optional<double> volume_m3;
  std::optional<double> initial_volume_m3;
  std::optional<double> gauge_pressure_pa;
  std::optional<double> gas_residual;       // pressure times volume over the amount of gas, less one
  std::string surface;                      // named surface of the mesh that it acts on; empty for none
  std::optional<Eigen::Vector3d> center_m;  // of that surface, in robot_base
  std::vector<Eigen::Vector3d> path_m;      // polyline to draw, in robot_base; empty for none
};

struct CommandLimits {
  double rest = 0.0;  // the command that asks for nothing
  double min = 0.0;
  double max = 0.0;
  std::string unit;  // "1" for contraction and beta, "m", "N", "ml", "Pa"
};

// How the laws of an actuator's constraints change with a number of its settings, for fitting it to measurements; at
// fixed positions, multipliers, command and slipped lengths.
struct LawChange {
  Eigen::VectorXd offsets;     // per constraint: of offset - compliance * y
  Eigen::VectorXd log_ratios;  // per contact
};

// Where a step starts. A search for a rest state has an infinite time step (a memory, which is finite, has 0 for it).
struct StepStart {
  double time_step_s;
  const Eigen::Matrix3Xd& positions_m;
  const Eigen::Matrix3Xd& velocities_m_s;
  std::vector<double> multipliers;  // as in observe
};

class Actuator {
 public:
  virtual ~Actuator() = default;

  // Reads its own section of the scene (plugins refuse bad settings with the fix in the message) and binds to the rest
  // shape. Throws SettingsError.
  void initialise(const YamlNode& settings, const Body& body, const MeshLocator& locator);

  const std::string& name() const { return name_; }
  const CommandLimits& limits() const { return limits_; }
  double command_speed() const { return command_speed_; }  // largest change of the command per second; 0: no limit

  // The rest command and the memory of the start.
  DriveState rest_state() const;

  // Throws std::invalid_argument with name, value and allowed range.
  void require_in_limits(double command) const;

  // The same; the old command then stays.
  void set_command(double command, DriveState& drive) const;

  // Moves the actuated value towards the command, no faster than the drive can in that time; an infinite time arrives.
  void advance(double time_step_s, DriveState& drive) const;

  // Puts the actuated value to a place between without asking the drive.
  void place(double actuated_command, DriveState& drive) const;

  // Valid as long as the actuator; the same objects at every call. All follow the one command.
  virtual std::vector<const Constraint*> constraints() const = 0;

  // Where constraints of this actuator meet; as valid as they.
  virtual std::vector<const FrictionContact*> friction_contacts() const { return {}; }

  // Energies that follow the command beside or in place of constraints; as valid as they. For solver.method newton.
  virtual std::vector<const EnergyTerm*> energy_terms() const { return {}; }

  // What depends on the past, such as a pump's flow or a damper's rate, takes it from the state that a time step starts
  // from, and writes it into the memory. A step that is cut begins anew with each part; several may begin before one is
  // accepted.
  virtual void begin_step(const StepStart& /*start*/, DriveState& /*drive*/) const {}

  // A step was accepted in which these lengths [m] slipped, one per contact: writes into the memory what is to be
  // kept.
  virtual void end_step(const std::vector<double>& /*slips_m*/, DriveState& /*drive*/) const {}

  // Until the next step begins it keeps `share` of what it has supplied in this state and no more, whatever its
  // command, as a regulator whose valve is closed keeps its gas. False where it supplies nothing that could be kept.
  virtual bool keep_supply(double /*share*/, const StepStart& /*now*/, DriveState& /*drive*/) const { return false; }

  // Empty, or why there is no rest state to be sought with this actuator.
  virtual std::string why_no_equilibrium() const { return ""; }

  // Per unit of the number with that key, at these multipliers; nullopt where nothing follows from such a number.
  virtual std::optional<LawChange> law_change(const std::string& /*key*/, const Eigen::Matrix3Xd& /*positions_m*/,
                                              const std::vector<double>& /*multipliers*/,
                                              const DriveState& /*drive*/) const {
    return std::nullopt;
  }

  // `multipliers`: one per constraint, in their order.
  virtual ActuatorReading observe(const Eigen::Matrix3Xd& positions_m, const std::vector<double>& multipliers,
                                  const DriveState& drive) const = 0;

 protected:
  // Reads the plugin's keys, binds to the rest shape and fills `limits_` and `command_speed_`; `name` is read already.
  // Body and locator are not kept: they move when the simulation is put together.
  virtual void on_initialise(const YamlNode& settings, const Body& body, const MeshLocator& locator) = 0;

  // What DriveState::memory is at the start.
  virtual Eigen::VectorXd initial_memory() const { return {}; }

  CommandLimits limits_;
  double command_speed_ = 0.0;  // as command_speed()
  double start_delay_s_ = 0.0;  // before a drive at rest starts to move

 private:
  std::string name_;
};

}  // namespace soft_robot_lab
