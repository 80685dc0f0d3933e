// SPDX-License-Identifier: BSD-3-Clause
// The plugin library: this package's actuators for pluginlib (config/actuator_plugins.xml).
#include <pluginlib/class_list_macros.hpp>

#include "soft_robot_lab/mechanics/actuators/cable.h"
#include "soft_robot_lab/mechanics/actuators/chamber.h"

PLUGINLIB_EXPORT_CLASS(soft_robot_lab::Cable, soft_robot_lab::Actuator)
PLUGINLIB_EXPORT_CLASS(soft_robot_lab::Chamber, soft_robot_lab::Actuator)
