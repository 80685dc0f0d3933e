// The plugin interface of everything that drives the body: cables, air chambers, and what a lab adds of its own.
// Called in this order: initialise once; then per command set_command; per time step begin_step and advance; per solver
// iteration the constraints; after a solve observe.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/sim/constraint.h"

namespace soft_robot_lab {

class Body;
class MeshLocator;
class SettingsNode;

// What an actuator measures; members that make no sense for its kind stay empty.
struct ActuatorReading {
  std::string name;
  double command = 0.0;           // as last commanded
  double actuated_command = 0.0;  // as reached within the speed limit
  std::optional<double> length_m;
  std::optional<double> rest_length_m;
  std::optional<double> tension_n;
  std::optional<double> volume_m3;
  std::optional<double> initial_volume_m3;
  std::optional<double> gauge_pressure_pa;
  std::optional<double> gas_residual;   // pressure times volume over the amount of gas, less one
  std::vector<Eigen::Vector3d> path_m;  // polyline to draw, in robot_base; empty for none
};

struct CommandLimits {
  double rest = 0.0;  // the command that asks for nothing
  double min = 0.0;
  double max = 0.0;
  std::string unit;  // "1" for contraction and beta, "m", "N", "ml", "Pa"
};

class Actuator {
 public:
  virtual ~Actuator() = default;

  // Reads its own section of the scene (plugins refuse bad settings with the fix in the message) and binds to the rest
  // shape. Throws SettingsError.
  void initialise(const SettingsNode& settings, const Body& body, const MeshLocator& locator);

  const std::string& name() const { return name_; }
  const CommandLimits& limits() const { return limits_; }
  double command() const { return command_; }
  double actuated_command() const { return actuated_command_; }

  // Throws std::invalid_argument with name, value and allowed range; the old command then stays.
  void set_command(double command);

  // What depends on the past, such as a pump's flow, takes it from the state that a time step starts from; the step is
  // infinite before an equilibrium. `multipliers` as in observe.
  virtual void begin_step(double /*time_step_s*/, const Eigen::Matrix3Xd& /*positions_m*/,
                          const std::vector<double>& /*multipliers*/) {}

  // Moves the actuated value towards the command, no faster than the drive can in that time; an infinite time arrives.
  void advance(double time_step_s);

  // Puts command and actuated value to `actuated` at once: restores a saved state.
  void restore(double command, double actuated_command);

  // Valid as long as the actuator; the same objects at every call. All follow the one command.
  virtual std::vector<const Constraint*> constraints() const = 0;

  // `multipliers`: one per constraint, in their order.
  virtual ActuatorReading observe(const Eigen::Matrix3Xd& positions_m,
                                  const std::vector<double>& multipliers) const = 0;

 protected:
  // Reads the plugin's keys, binds to the rest shape and fills `limits_` and `command_speed_`; `name` is read already.
  // Body and locator are not kept: they move when the simulation is put together.
  virtual void on_initialise(const SettingsNode& settings, const Body& body, const MeshLocator& locator) = 0;

  // Hands the actuated command, which has just changed, to the constraints.
  virtual void actuate(double command) = 0;

  CommandLimits limits_;
  double command_speed_ = 0.0;  // largest change of the command per second; 0: no limit

 private:
  std::string name_;
  double command_ = 0.0;
  double actuated_command_ = 0.0;
};

}  // namespace soft_robot_lab
