// SPDX-License-Identifier: BSD-3-Clause
// The air chamber: gas behind a named surface of the body.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "enclosed_volume.h"
#include "soft_robot_lab/mechanics/actuator.h"

namespace soft_robot_lab {

// Isothermal ideal gas that fills the chamber and a dead volume (tube and syringe), with the atmosphere outside:
//   (p + P0) (V + dead volume) = amount,   U(V) = P0 V - amount ln(V + dead volume),   dU/dV = -p
struct IsothermalGas {
  double outside_pressure_pa = 101000.0;  // P0, absolute, also inside at rest
  double amount_j = 0.0;                  // pressure times volume
  double dead_volume_m3 = 0.0;
  double amount_per_command = 0.0;
  double dead_volume_per_command = 0.0;

  double gauge_pressure_pa(double volume_m3) const {
    return amount_j / (volume_m3 + dead_volume_m3) - outside_pressure_pa;
  }
};

// Constraint on a chamber's volume V [m^3]; its multiplier is minus the gauge pressure [Pa].
class ChamberVolume : public Constraint {
 public:
  explicit ChamberVolume(EnclosedVolume surface) : surface_(std::move(surface)) {}

  std::vector<EmbeddedPoint> carried_points() const override { return surface_.cap_centres(); }
  std::vector<Clique> cliques() const override { return surface_.cliques(); }
  double value(const Eigen::Matrix3Xd& positions_m) const override;
  void add_gradient(const Eigen::Matrix3Xd& positions_m, double scale, Eigen::Matrix3Xd& gradient) const override;
  void add_hessian(const Eigen::Matrix3Xd& positions_m, double scale, CliqueSink& hessian) const override;
  ConstraintLaw law(double volume_m3, double multiplier) const override;

  double volume_m3(const Eigen::Matrix3Xd& positions_m) const { return surface_.value_m3(positions_m); }

  void fill(const IsothermalGas& gas);
  // A regulator that can bring the amount of gas to anything within the range.
  void regulate(double gauge_pressure_pa, const IsothermalGas& least, const IsothermalGas& most);
  // A pressure from before, as a load that keeps size and direction until the next of these calls.
  void load(double gauge_pressure_pa, const Eigen::Matrix3Xd& positions_m);

  const IsothermalGas& gas() const { return gas_; }

 private:
  ConstraintLaw gas_law(const IsothermalGas& gas, double volume_m3, double multiplier) const;

  EnclosedVolume surface_;
  IsothermalGas gas_, most_gas_;
  bool regulated_ = false;
  bool load_ = false;
  double prescribed_pressure_pa_ = 0.0;
  double load_volume_m3_ = 0.0;  // V and dV/dx where the load was set
  Eigen::Matrix3Xd load_positions_m_, load_gradient_m2_;
};

// Plugin "soft_robot_lab/Chamber". Settings: name; surface: a named surface of the mesh; initial_pressure_pa; command:
//   beta            amount of gas over the initial amount
//   syringe         plunger travel [ml] of a closed system with syringe_volume_ml and tube_volume_ml at rest, which
//                   other commands read and leave unused
//   volume_offset   gas added [ml, at initial pressure]: beta = 1 + offset / initial volume
//   gauge_pressure  what a regulator holds [Pa]
// flow_ml_s: the pump's or plunger's speed in ml of gas at initial pressure, 0 for no limit; limits: min_beta and
// max_beta, max_pull_ml, min_offset_ml and max_offset_ml, min_gauge_pressure_pa and max_gauge_pressure_pa.
// model: implicit, or explicit (the thesis's Algorithm 2: during a time step the pressure of the volume before it is a
// load that does not change).
class Chamber : public Actuator {
 public:
  std::vector<const Constraint*> constraints() const override { return {volume_.get()}; }
  void begin_step(const StepStart& start) override;
  ActuatorReading observe(const Eigen::Matrix3Xd& positions_m, const std::vector<double>& multipliers) const override;

 protected:
  void on_initialise(const YamlNode& settings, const Body& body, const MeshLocator& locator) override;
  void actuate(double command) override;

 private:
  enum class Command { beta, syringe, volume_offset, gauge_pressure };

  void bind(const YamlNode& settings, const TetMesh& mesh);
  void read_syringe(const YamlNode& settings, bool required);
  void read_command(const YamlNode& settings);
  void fill();
  IsothermalGas gas_at(double command) const;

  Command kind_ = Command::beta;
  bool explicit_ = false;
  double initial_pressure_pa_ = 101000.0;
  double initial_volume_m3_ = 0.0;
  double syringe_volume_m3_ = 0.0, tube_volume_m3_ = 0.0;
  double flow_m3_s_ = 0.0;
  std::unique_ptr<ChamberVolume> volume_;
  std::string surface_;     // its name in the mesh
  std::vector<int> nodes_;  // of the surface

  // What the step began with.
  double time_step_s_ = std::numeric_limits<double>::infinity();
  double amount_before_j_ = 0.0;
  Eigen::Matrix3Xd positions_before_m_;
};

}  // namespace soft_robot_lab
