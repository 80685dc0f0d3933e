// A body with its actuators and markers, moved through time or to equilibrium.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/sim/actuator.h"
#include "soft_robot_lab/sim/body.h"
#include "soft_robot_lab/sim/marker.h"

namespace soft_robot_lab {

enum class Integrator {
  implicit_euler,  // first order, damps
  bdf2             // second order, damps little; the first step after a start or an equilibrium is implicit Euler
};

struct SolverOptions {
  // global: Newton on everything at once. gauss_seidel: XPBD, one element after another in substeps; for comparison and
  // for large meshes.
  enum class Method { global, gauss_seidel };
  Method method = Method::global;
  Integrator integrator = Integrator::implicit_euler;  // gauss_seidel knows no other
  double time_step_s = 1.0 / 60.0;                     // (0, 1]
  double tolerance = 1.0e-6;                           // (0, 1); force residual over the largest force in the body
  int max_iterations = 60;                             // [1, 10000] Newton iterations a step, or a continuation stage
  double dynamic_tolerance = 1.0e-3;  // (0, 1); the same for a time step, whose error the next step sees
  int substep_count = 20;             // [1, 10000] of gauss_seidel, a time step; one that creates energy is cut further
  int iteration_count = 1;            // [1, 10000] of gauss_seidel: sweeps over all elements, a substep
  void validate() const;              // throws std::invalid_argument: field, value, allowed range
};

struct Linearisation;  // of the solver, where its last factor serves further steps

// Everything that changes; copy it to save and restore.
struct SimulationState {
  double time_s = 0.0;
  Eigen::Matrix3Xd positions_m;            // 3 x nodes, robot_base
  Eigen::Matrix3Xd velocities_m_s;         // 3 x nodes
  Eigen::VectorXd element_multipliers_pa;  // one volume multiplier per element
  Eigen::VectorXd constraint_multipliers;  // in the order of the actuators' constraints
  Eigen::VectorXd element_forces_n;        // gauss_seidel: each element's, in an order of the solver's own; else empty
  std::vector<double> commands;            // per actuator
  std::vector<double> actuated_commands;   // per actuator
  std::vector<Eigen::VectorXd> actuator_memories;      // per actuator: what it carries from step to step
  std::shared_ptr<const Linearisation> linearisation;  // so that a restored state goes on to the last bit

  // What bdf2 knows of the step before; zero and empty where there is none, and with implicit_euler.
  double previous_step_s = 0.0;           // its length
  Eigen::Matrix3Xd previous_positions_m;  // at its start
  Eigen::Matrix3Xd previous_velocities_m_s;
};

// What a solve did. A solve that did not converge says so, and leaves the best state it had. A time step of
// gauss_seidel, which does a fixed amount of work, counts as converged where it created no energy; its residual tells
// how exact it was.
struct SolveReport {
  bool converged = false;
  int iterations = 0;      // Newton iterations (one linear solve each); sweeps of gauss_seidel
  int factorisations = 0;  // of them, those that needed a new matrix
  int steps = 0;           // time steps or continuation stages
  int rejected_steps = 0;  // iterations repeated shorter or with a shifted matrix
  double residual = 0.0;   // at the end: force residual over the largest force in the body
  double wall_s = 0.0;
  int inverted_elements = 0;
  std::string message;  // empty, or why it stopped short, with place and size
};

class Simulation {
 public:
  // Throws std::invalid_argument where no node is fixed, two actuators or markers share a name, or an option is out of
  // range.
  Simulation(Body body, std::vector<std::unique_ptr<Actuator>> actuators, std::vector<Marker> markers,
             const SolverOptions& options);
  ~Simulation();
  Simulation(Simulation&&) noexcept;

  // Throws std::invalid_argument naming actuator, value and allowed range; nothing changes then.
  void set_command(const std::string& actuator, double command);

  // One time step of SolverOptions::time_step_s.
  SolveReport step();

  // The stable rest state for the present commands, reached from the present state; velocities become zero. Throws
  // std::invalid_argument where an actuator has none.
  SolveReport solve_equilibrium();

  // d marker / d command at the present equilibrium: 3*markers x actuators. Zero where a command does nothing (slack
  // cable). Where friction tells going on from turning back, what slipped last goes on.
  Eigen::MatrixXd marker_sensitivities();

  void reset();  // rest shape, rest commands, time zero
  const SimulationState& state() const;
  void set_state(const SimulationState& state);  // throws std::invalid_argument: wrong size or not finite

  const Body& body() const;
  const SolverOptions& options() const;
  const std::vector<Marker>& markers() const;
  const std::vector<std::unique_ptr<Actuator>>& actuators() const;
  int actuator_index(const std::string& name) const;  // throws std::invalid_argument listing the names
  int marker_index(const std::string& name) const;    // the same

  Eigen::Vector3d marker_position(int marker) const;
  ActuatorReading actuator_state(int actuator) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace soft_robot_lab
