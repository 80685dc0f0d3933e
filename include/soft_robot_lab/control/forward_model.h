// SPDX-License-Identifier: BSD-3-Clause
// What the controller believes: commands in, marker positions at rest out. Wraps a simulation of its own.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "reach_problem.h"
#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// No equilibrium was found for some commands; the message carries the solver's.
class ForwardModelError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The simulation's interrupt asked for an end; the simulation is as it was before.
class ForwardModelInterrupted : public std::runtime_error {
 public:
  ForwardModelInterrupted() : std::runtime_error("interrupted") {}
};

// Whether a simulation's interrupt asks for an end now.
bool asked_to_end(const Simulation& simulation);

class ForwardModel {
 public:
  // Names in the simulation; throws std::invalid_argument listing the known ones.
  ForwardModel(Simulation& simulation, const std::vector<std::string>& markers,
               const std::vector<std::string>& actuators);

  // Equilibrium from the nearest of the last ones found (warm start), so neighbouring queries are cheap, also after a
  // step that went too far; a large change of commands is followed in stages, as a body that buckles may lose its way
  // in one. Throws ForwardModelError where none was found, or where it is not stable, and std::invalid_argument for a
  // command beyond an actuator's limits, and ForwardModelInterrupted; the simulation is then as it was before.
  Prediction predict(const Eigen::VectorXd& commands, bool with_derivatives);

  // The same for a step of a search, which would rather cut a long one than follow it dearly: throws ForwardModelError
  // too where the body would buckle on the way, and the equilibrium is rough (residual 1e-3), also where it is asked
  // for again. A short step is answered like any other.
  Prediction try_out(const Eigen::VectorXd& commands, bool with_derivatives);

  // Makes itself the problem's models; must outlive their use.
  void answer_for(ReachProblem& problem);

 private:
  struct Known {
    Eigen::VectorXd commands;
    SimulationState state;
  };

  Prediction answer(const Eigen::VectorXd& commands, bool with_derivatives, bool trial);
  double distance(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const;  // of commands, in their ranges
  bool start_near(const Eigen::VectorXd& commands);  // whether that is at these commands already
  void remember(const Eigen::VectorXd& commands);
  void settle(const Eigen::VectorXd& commands, bool trial);
  void add_derivatives(Prediction& prediction) const;
  const Actuator& actuator(Eigen::Index command) const;

  Simulation& simulation_;
  std::vector<int> markers_;
  std::vector<int> actuators_;
  std::vector<Known> known_;  // the first stays
};

}  // namespace soft_robot_lab
