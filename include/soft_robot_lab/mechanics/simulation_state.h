// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "drive_state.h"
#include "obstacle.h"

namespace soft_robot_lab {

struct Linearisation;  // of the solver, where its last factor serves further steps

// Everything that changes; copy it to save and restore. Plain numbers but for `linearisation`.
struct SimulationState {
  double time_s = 0.0;
  Eigen::Matrix3Xd positions_m;     // 3 x nodes, robot_base
  Eigen::Matrix3Xd velocities_m_s;  // 3 x nodes
  Eigen::VectorXd
      element_multipliers_pa;  // one volume multiplier per element, or per vertex; then tensions of fibres [N]
  Eigen::VectorXd constraint_multipliers;  // in the order of the actuators' constraints
  ContactState contact;
  FreeVelocities free_velocities;  // of free obstacles
  // xpbd: each element's, in an order of the solver's own; empty with `newton`, and in a state that is set:
  // those of the shape at rest.
  Eigen::VectorXd element_forces_n;
  Eigen::VectorXd branch_stress_pa;  // of hysteresis, in an order of the solver's own; empty without
  DriveStates drives;                // per actuator

  // Of holds that move, 3 x nodes: what inertia and damping add to their reaction; empty where none moves, or at rest.
  Eigen::Matrix3Xd hold_inertia_n;

  std::optional<double> rest_residual;  // where the body is at rest: it sleeps until something changes

  int inverted_steps = 0;  // time steps, up to now, that ended with inverted elements

  // What a time step knows of the one before; zero and empty where there is none.
  double previous_step_s = 0.0;           // its length
  Eigen::Matrix3Xd previous_positions_m;  // at its start
  Eigen::Matrix3Xd previous_velocities_m_s;
  Eigen::VectorXd previous_element_multipliers_pa;
  Eigen::VectorXd previous_constraint_multipliers;
  Eigen::VectorXd previous_pressures_pa;  // of contact
  FreePoses previous_free;
  FreeVelocities previous_free_velocities;
  // What the trapezoidal rule needs of its end; empty but for tr_bdf2. Of free obstacles by what they are driven.
  Eigen::Matrix3Xd accelerations_m_s2;
  Eigen::Matrix3Xd free_forces_n;  // force and torque of each

  // Where the matrix was made whose factor serves further steps. It decides no more than how near to its tolerance a
  // solve ends: with it a restored state goes on to the last bit as if it had never stopped, without it (null) to
  // within the tolerance. So it does not count where states are compared. Constant, and shared by copies of the state.
  std::shared_ptr<const Linearisation> linearisation;

  std::vector<double> commands() const;           // per actuator
  std::vector<double> actuated_commands() const;  // per actuator

  // The commands, and how far they are reached, of a state of the same actuators; their memories stay as they are.
  void take_commands(const SimulationState& from);
};

// Whether all numbers are equal to the last bit.
bool operator==(const SimulationState& a, const SimulationState& b);
inline bool operator!=(const SimulationState& a, const SimulationState& b) { return !(a == b); }

}  // namespace soft_robot_lab
