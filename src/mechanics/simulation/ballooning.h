// SPDX-License-Identifier: BSD-3-Clause
// Chambers under a held pressure beyond what their walls can hold: they grow at less and less pressure.
#pragma once

#include <string>
#include <vector>

#include "simulation_parts.h"

namespace soft_robot_lab {

class Ballooning {
 public:
  // From the present state, which is at rest.
  explicit Ballooning(const SimulationParts& parts);

  // Which chamber has grown since by more than 15 %, to more than 3 times its volume in the rest shape, and at which
  // pressure it was at rest; empty where none has.
  std::string found(const SimulationParts& parts) const;

 private:
  std::vector<ActuatorReading> at_rest_;
};

}  // namespace soft_robot_lab
