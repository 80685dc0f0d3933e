// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "reduced_model.h"
#include "reduced_newton.h"
#include "soft_robot_lab/mechanics/simulation_state.h"

namespace soft_robot_lab {

struct ReducedState {
  double time_s = 0.0;
  ReducedUnknowns at;
  Eigen::VectorXd velocity, previous_velocity;  // of q, per second
  double previous_step_s = 0.0;                 // zero: none, and previous_velocity is of no meaning
  DriveStates drives;
};

struct ReducedReport {
  bool converged = false;
  std::string interrupted;  // empty, or why; then the state is the one from before
  int iterations = 0, factorisations = 0;
  int steps = 0;  // time steps, or those of a continuation
};

// A reduced model that is moved through time by implicit Euler, or to equilibrium. Start: the rest shape.
class ReducedSimulation {
 public:
  explicit ReducedSimulation(std::shared_ptr<const ReducedModel> model);

  // Throws std::invalid_argument naming actuator, value and the trained range; nothing changes then.
  void set_command(const std::string& actuator, double command);

  // As Simulation has it, with the time limit of the full model's options.
  void set_interrupt(std::function<bool()> ends) { interrupt_.ends = std::move(ends); }

  // One time step of the full model's SolverOptions::time_step_s, in halves where it does not converge. Where it fails
  // the state stays as it was.
  ReducedReport step();

  // The stable rest state near the present one; where there is none, and the actuators come from their rest commands,
  // that beside one to which training went from there. Where none of those leads to one it has not converged, as which
  // of several sides a search takes is chance. From elsewhere it searches. With cables that rub it goes along the
  // commands, and no further. Where it fails the state stays as it was.
  ReducedReport solve_equilibrium();

  // The same by Newton's method alone: converges only to what is near. Where it does not the state stays as it was.
  ReducedReport solve_nearby();

  // Rms displacement of the last Newton iteration, > 0; smaller than the model's error is of no use.
  void set_tolerance_m(double time_step_m, double equilibrium_m);

  void reset();
  const ReducedState& state() const { return state_; }
  void set_state(const ReducedState& state) { state_ = state; }
  const ReducedModel& model() const { return *model_; }
  const std::vector<std::unique_ptr<const Actuator>>& actuators() const { return model_->full->actuators(); }
  int inverted_elements() const;  // of the full model at the present shape
  Eigen::Matrix3Xd positions_m() const { return model_->positions_m(state_.at.q); }

 private:
  // Actuated commands move evenly within a step, however it is cut.
  struct CommandPath {
    std::vector<double> from, to;
  };
  // Heeds the interrupt meanwhile.
  ReducedReport run(const std::function<void(ReducedReport&)>& solve);
  CommandPath advance_drives(double h);
  Eigen::VectorXd predicted(double h) const;
  // The part of a step of length h from one share of it to another.
  bool advance(double h, const CommandPath& path, double from, double to, ReducedReport& report);
  // Actuator::begin_step and end_step.
  void begin_step(double h);
  void keep_slips();
  void place_drives(const CommandPath& path, double share);
  CommandPath come_to_rest();  // all but the shape; returns the way that the drives took
  bool relax(int most_iterations, ReducedReport& report);
  void seek_equilibrium(ReducedReport& report);
  bool at_rest_commands() const;
  bool relax_along_commands(const CommandPath& path, ReducedReport& report);
  bool relax_beside_known_rests(ReducedReport& report);

  std::shared_ptr<const ReducedModel> model_;
  ReducedState state_;
  Interrupt interrupt_;
  ReducedNewton newton_;
  double step_tolerance_m_ = 3e-6, rest_tolerance_m_ = 1e-8;
};

// The full model in a reduced state; what a reduced state does not know stays as in `base`.
SimulationState full_state(const ReducedModel& model, const ReducedState& state, SimulationState base);

// The reduced state nearest to one of the full model, by mass; skin pushes nothing in it.
ReducedState nearest_state(const ReducedModel& model, const SimulationState& full);

}  // namespace soft_robot_lab
