// SPDX-License-Identifier: BSD-3-Clause
// The air chamber: gas behind a named surface of the body.
#pragma once

#include <memory>
#include <optional>
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

// What drives the gas in a chamber at one command, in one step.
struct GasSupply {
  IsothermalGas gas;       // of a regulator: the least that it leaves
  IsothermalGas most_gas;  // of a regulator: the most that it brings
  bool regulated = false;
  bool load = false;                    // a pressure from before, which keeps size and direction
  double prescribed_pressure_pa = 0.0;  // of a regulator or a load; gauge
};

// Constraint on a chamber's volume V [m^3]; its multiplier is minus the gauge pressure [Pa].
class ChamberVolume : public Constraint {
 public:
  // How the drive is read.
  class Supply {
   public:
    virtual ~Supply() = default;
    virtual GasSupply supply(const DriveState& drive) const = 0;
    // Where the nodes were when the step began, if the pressure is a load of that shape.
    virtual std::optional<Eigen::Matrix3Xd> load_positions_m(const DriveState& drive) const = 0;
  };

  // `supply` outlives this.
  ChamberVolume(EnclosedVolume surface, const Supply& supply) : surface_(std::move(surface)), supply_(supply) {}

  // Whether its pressure is a load of the shape with which the step began.
  bool is_load(const DriveState& drive) const { return supply_.load_positions_m(drive).has_value(); }

  std::vector<EmbeddedPoint> carried_points() const override { return surface_.cap_centres(); }
  std::vector<Clique> cliques() const override { return surface_.cliques(); }
  double value(const Eigen::Matrix3Xd& positions_m, const DriveState& drive) const override;
  void add_gradient(const Eigen::Matrix3Xd& positions_m, const DriveState& drive, double scale,
                    Eigen::Matrix3Xd& gradient) const override;
  void add_hessian(const Eigen::Matrix3Xd& positions_m, const DriveState& drive, double scale,
                   CliqueSink& hessian) const override;
  ConstraintLaw law(double volume_m3, double multiplier, const DriveState& drive) const override;

  double volume_m3(const Eigen::Matrix3Xd& positions_m) const { return surface_.value_m3(positions_m); }
  const EnclosedVolume& surface() const { return surface_; }

 private:
  EnclosedVolume surface_;
  const Supply& supply_;
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
class Chamber : public Actuator, private ChamberVolume::Supply {
 public:
  std::vector<const Constraint*> constraints() const override { return {volume_.get()}; }
  void begin_step(const StepStart& start, DriveState& drive) const override;
  bool keep_supply(double share, const StepStart& now, DriveState& drive) const override;
  ActuatorReading observe(const Eigen::Matrix3Xd& positions_m, const std::vector<double>& multipliers,
                          const DriveState& drive) const override;

 protected:
  void on_initialise(const YamlNode& settings, const Body& body, const MeshLocator& locator) override;
  Eigen::VectorXd initial_memory() const override;

 private:
  enum class Command { beta, syringe, volume_offset, gauge_pressure };

  void bind(const YamlNode& settings, const TetMesh& mesh);
  void read_syringe(const YamlNode& settings, bool required);
  void read_command(const YamlNode& settings);
  IsothermalGas gas_at(double command) const;
  GasSupply supply(const DriveState& drive) const override;
  GasSupply regulated(const DriveState& drive) const;
  double gas_j(const StepStart& at) const;
  std::optional<Eigen::Matrix3Xd> load_positions_m(const DriveState& drive) const override;

  Command kind_ = Command::beta;
  bool explicit_ = false;
  double initial_pressure_pa_ = 101000.0;
  double initial_volume_m3_ = 0.0;
  double syringe_volume_m3_ = 0.0, tube_volume_m3_ = 0.0;
  double flow_m3_s_ = 0.0;
  std::unique_ptr<ChamberVolume> volume_;
  std::string surface_;          // its name in the mesh
  std::vector<int> nodes_;       // of the surface
  Eigen::Index node_count_ = 0;  // of the body
};

}  // namespace soft_robot_lab
