// SPDX-License-Identifier: BSD-3-Clause
#include "soft_robot_lab/mechanics/actuators/factory.h"

#include <stdexcept>

#include "soft_robot_lab/mechanics/actuators/cable.h"
#include "soft_robot_lab/mechanics/actuators/chamber.h"

namespace soft_robot_lab {

std::unique_ptr<Actuator> make_actuator(const std::string& plugin) {
  if (plugin == "soft_robot_lab/Cable") return std::make_unique<Cable>();
  if (plugin == "soft_robot_lab/Chamber") return std::make_unique<Chamber>();
  throw std::invalid_argument("unknown actuator plugin '" + plugin +
                              "'; known: soft_robot_lab/Cable, soft_robot_lab/Chamber");
}

}  // namespace soft_robot_lab
