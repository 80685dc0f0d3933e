// SPDX-License-Identifier: BSD-3-Clause
// Chambers under a held pressure beyond what their walls can hold: they grow at less and less pressure.
#pragma once

#include <string>
#include <vector>

#include "simulation_parts.h"
#include "soft_robot_lab/mechanics/solve_report.h"

namespace soft_robot_lab {

class Ballooning {
 public:
  // From the present state, which is at rest.
  explicit Ballooning(const SimulationParts& parts);

  // Which chamber has grown since by more than 15 %, to more than 3 times its volume in the rest shape, and at which
  // pressure it was at rest; empty where none has.
  std::string found(const SimulationParts& parts) const;

  // The same before anything falls: lets gas into the chamber that has grown most, of those whose pressure is to rise,
  // a little at a time. Empty where it gets to its pressure, or comes to no rest. The state stays.
  std::string under_more_gas(SimulationParts& parts, SolveReport& report) const;

 private:
  int next_to_grow(const SimulationParts& parts) const;  // -1: none

  std::vector<ActuatorReading> at_rest_;
};

}  // namespace soft_robot_lab
