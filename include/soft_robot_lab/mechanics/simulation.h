// SPDX-License-Identifier: BSD-3-Clause
// A model that is moved through time or to equilibrium: the model, which several simulations may share, a workspace and
// a state of its own.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "energy_ledger.h"
#include "model.h"
#include "simulation_state.h"
#include "solve_report.h"

namespace soft_robot_lab {

struct SimulationParts;

// A number of the scene on which equilibria depend, as a fit to measurements changes it.
struct ModelParameter {
  std::string key;             // of these actuators' settings (Actuator::law_change)
  std::vector<int> actuators;  // empty: the body's density_kg_m3, or youngs_modulus_pa, with which all moduli grow
};

// A force that acts at a point of the body and keeps its direction.
struct PointLoad {
  EmbeddedPoint at;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
};

class Simulation {
 public:
  // A model of its own; throws as Model's constructor.
  Simulation(Body body, std::vector<std::unique_ptr<Actuator>> actuators, std::vector<Marker> markers,
             const SolverOptions& options);
  // In the rest shape. For each thread one, of the same model: they share nothing that changes, and their numbers are
  // those of one thread to the last bit.
  explicit Simulation(std::shared_ptr<const Model> model);
  ~Simulation();
  Simulation(Simulation&&) noexcept;

  // Throws std::invalid_argument naming actuator, value and allowed range; nothing changes then.
  void set_command(const std::string& actuator, double command);

  // Asked all along in every solve, by the thread that solves: where it answers true the solve ends, the state is the
  // one from before, and the report says "interrupted". Empty: never. It is no part of the state.
  void set_interrupt(std::function<bool()> ends);
  const std::function<bool()>& interrupt() const;

  // One time step of SolverOptions::time_step_s.
  SolveReport step();

  // The stable rest state for the present commands, reached from the present state, or from the rest shape where the
  // present state has inverted elements (a tangle may hold itself); velocities become zero. Throws
  // std::invalid_argument where an actuator has none.
  SolveReport solve_equilibrium(const EquilibriumOptions& options = {});

  // d marker / d command at the present equilibrium: 3*markers x actuators. Zero where a command does nothing (slack
  // cable). Where friction distinguishes going on from turning back, what slipped last goes on. `tensions_n`, where
  // given, becomes d tension / d command, actuators x actuators; zero where there is no tension.
  Eigen::MatrixXd marker_sensitivities(Eigen::MatrixXd* tensions_n = nullptr);

  // d marker / d parameter at the present equilibrium and commands: 3*markers x parameters. With friction it depends on
  // the way here: `slipped_m`, d length slipped so far / d parameter, friction_contacts x parameters, is what
  // equilibria hand on; start it empty at the rest shape, and ask at every equilibrium on the way. Throws
  // std::invalid_argument for a parameter that an actuator does not know, std::runtime_error where the equilibrium is
  // not stable.
  Eigen::MatrixXd parameter_sensitivities(const std::vector<ModelParameter>& parameters, Eigen::MatrixXd& slipped_m);

  // d node / d force at a marker [m/N], commands held: 3*nodes x 3*markers, of held axes zero; in motion as if the
  // present state were an equilibrium. By reciprocity (Betti) its transpose says how forces at nodes move markers;
  // where friction slips, which has no energy, that is an approximation. Throws std::runtime_error where it is not
  // stable.
  Eigen::MatrixXd marker_compliances();

  // Keeps account of energy from the present state on; costs a pass over the body in every step. Not with method xpbd.
  void keep_energy_ledger();
  const EnergyLedger* energy_ledger() const;  // null where none is kept

  // Pulls and pushes at points of the body as hands would, in place of the loads before; none lets go. They are no part
  // of the state: reset and set_state leave them. Throws std::invalid_argument where one is not finite or names a node
  // that there is not, and while an energy ledger is kept, which knows no such work.
  void pull(const std::vector<PointLoad>& loads);

  void reset();  // rest shape, rest commands, time zero
  const SimulationState& state() const;
  void set_state(const SimulationState& state);  // throws std::invalid_argument: wrong size or not finite

  const std::shared_ptr<const Model>& model() const;
  const Body& body() const;
  const SolverOptions& options() const;
  const std::vector<Marker>& markers() const;
  const std::vector<std::unique_ptr<const Actuator>>& actuators() const;
  int actuator_index(const std::string& name) const;  // throws std::invalid_argument listing the names
  int marker_index(const std::string& name) const;    // the same

  // What holds the held nodes, 3 x nodes [N]; zero on free axes. At rest it balances gravity, loads, cables and contact
  // to the solver's tolerance; in motion it leaves out what damping and hysteresis add, unless a hold moves: then it
  // has these and the inertia of the held nodes.
  Eigen::Matrix3Xd reaction_forces_n() const;

  Eigen::Vector3d marker_position(int marker) const;
  ActuatorReading actuator_state(int actuator) const;
  // One for each obstacle, also where it does not touch; then one for each that a free obstacle touches or may touch.
  std::vector<ContactReading> contacts() const;
  // What passes through silicone where the scene models no contact: a warning for each actuator whose path runs through
  // air at rest, and one for skin; one more for skin that is deep in silicone in spite of contact. Equilibria have them
  // in their report; time steps do not.
  std::vector<SolveWarning> unmodelled_contact() const;
  std::vector<Eigen::Isometry3d> obstacle_poses() const;  // from each shape as stated to where it stands

 private:
  void take_along_linearisation();
  SolveReport timed(const std::function<void(SolveReport&)>& solve);

  std::unique_ptr<SimulationParts> parts_;
};

}  // namespace soft_robot_lab
