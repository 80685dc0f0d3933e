// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "soft_robot_lab/mechanics/simulation.h"

namespace soft_robot_lab {

// Says of a solve that takes long how long it runs, and to what its chambers have come: first after two seconds, and
// then ever less often. Asked from within the solve (Simulation::set_interrupt).
class SolveWatch {
 public:
  explicit SolveWatch(const Simulation& simulation) : simulation_(simulation) {}  // which outlives this

  void begin(double now_s);                      // of a solve
  std::optional<std::string> say(double now_s);  // nothing where it is too early

 private:
  const Simulation& simulation_;
  double begin_s_ = 0.0, next_s_ = 0.0;
};

}  // namespace soft_robot_lab
