// What the controller believes: commands in, marker positions at rest out. Wraps a simulation of its own.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "soft_robot_lab/sim/simulation.h"

namespace soft_robot_lab {

// No equilibrium was found for some commands; the message carries the solver's.
class ForwardModelError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class ForwardModel {
 public:
  // `marker` and `actuators` are names in the simulation; throws std::invalid_argument listing the known ones.
  ForwardModel(Simulation& simulation, const std::string& marker, const std::vector<std::string>& actuators);

  // Equilibrium from the last one found (warm start), so neighbouring queries are cheap. Throws ForwardModelError where
  // none was found, or where it is not stable, and std::invalid_argument for a command beyond an actuator's limits; the
  // simulation is then as it was before.
  Eigen::Vector3d marker(const Eigen::VectorXd& commands, Eigen::Matrix3Xd* jacobian);

 private:
  Eigen::Matrix3Xd sensitivities() const;  // d marker / d command, 3 x commands

  Simulation& simulation_;
  int marker_;
  std::vector<int> actuators_;
};

}  // namespace soft_robot_lab
