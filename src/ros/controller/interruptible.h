// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <utility>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// As long as it lives, a simulation's solves end where this says so, in place of what did before.
class Interruptible {
 public:
  Interruptible(Simulation& simulation, std::function<bool()> ends)
      : simulation_(simulation), before_(simulation.interrupt()) {
    simulation.set_interrupt(std::move(ends));
  }
  ~Interruptible() { simulation_.set_interrupt(std::move(before_)); }
  Interruptible(const Interruptible&) = delete;
  Interruptible& operator=(const Interruptible&) = delete;

 private:
  Simulation& simulation_;
  std::function<bool()> before_;
};

}  // namespace soft_robot_lab
