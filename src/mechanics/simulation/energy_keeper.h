// SPDX-License-Identifier: BSD-3-Clause
// Keeps a simulation's EnergyLedger. A step's forces are taken where it ends, as the integrator takes them, and their
// work is what they do along the step; the work of what has a state at both ends is the trapezoidal rule's, and the
// difference of the two is the integrator's part.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "mechanics/newton/newton_solver.h"
#include "soft_robot_lab/mechanics/energy_ledger.h"
#include "soft_robot_lab/mechanics/simulation_state.h"

namespace soft_robot_lab {

struct SimulationParts;

// How a step ended.
struct StepEnd {
  StepWork work;
  double inertia_j = 0.0, drag_j = 0.0;  // work along the step
  Eigen::Matrix3Xd damping_n;            // drag and viscosity; empty where there is neither
  bool trapezoidal = false;              // damping acts as the mean of where the step starts and ends
};

class EnergyKeeper {
 public:
  explicit EnergyKeeper(const SimulationParts& parts);

  // `state`: after the step, with the slips that led there; of `after` the velocities.
  void add_step(const SimulationParts& parts, const SimulationState& before, StepEnd end, const NewtonState& state,
                const SimulationState& after);

  // Books what the state has other than where the last step ended, as forces that balance did not bring it there.
  void notice_rescue(const SimulationParts& parts, const SimulationState& now);

  const EnergyLedger& ledger() const { return ledger_; }

 private:
  double stored_j() const { return ledger_.kinetic_j + ledger_.elastic_j + ledger_.gravity_j + ledger_.loads_j; }
  struct Motion {
    Eigen::Matrix3Xd positions_m, velocities_m_s;
    FreePoses free;
    FreeVelocities free_velocities;
  };
  void take_stock(const SimulationParts& parts, Motion at, double elastic_j);
  double damped_j(const StepEnd& end, const Eigen::Matrix3Xd& way_m) const;

  EnergyLedger ledger_;
  double start_j_ = 0.0;
  std::vector<char> gas_;  // per constraint
  Motion known_;
  Eigen::Matrix3Xd reactions_n_, damping_n_;  // where the last step ended; empty before the first
};

}  // namespace soft_robot_lab
