// SPDX-License-Identifier: BSD-3-Clause
// Actuators from plugin libraries, this package's and those of other packages.
#pragma once

#include "soft_robot_lab/robot/scene/scene.h"

namespace soft_robot_lab {

// The factory, and every copy of it, keeps the libraries loaded, and the libraries stay once an actuator was made, so
// that actuators may outlive it.
ActuatorFactory actuators_from_plugins();

}  // namespace soft_robot_lab
